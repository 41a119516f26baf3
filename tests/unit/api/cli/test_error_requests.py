"""Errors by their names among all."""

import httpx
import pytest

from api.cli.error_requests import acknowledge, open_errors, shelve, unshelve
from api.client.outcomes import ServiceProblemError
from tests.support.asked_service import AskedService
from tests.unit.api.cli.test_error_lines import item

UNKNOWN = httpx.Response(404, json={"code": "UNKNOWN_ERROR", "detail": "there is no such error"})


def test_a_name_has_the_part_in_front() -> None:
    service = AskedService(
        {
            "GET /nodes/left/lidar": {"name": "left/lidar"},
            "POST /nodes/left/lidar/errors/SILENT/acknowledge": {},
            "PUT /errors/ESTOP/shelf": item("ESTOP"),
            "DELETE /errors/ESTOP/shelf": httpx.Response(204),
            "GET /errors?open=true&part=left%2Flidar": {"items": []},
        }
    )
    client = service.client()

    acknowledge(client, "left/lidar.SILENT")
    assert shelve(client, "ESTOP", 60.0, "known")["error"] == "ESTOP"
    unshelve(client, "ESTOP")
    assert open_errors(client, "left/lidar") == {"items": []}

    assert [asked[:2] for asked in service.writes] == [
        ("POST", "/nodes/left/lidar/errors/SILENT/acknowledge"),
        ("PUT", "/errors/ESTOP/shelf"),
        ("DELETE", "/errors/ESTOP/shelf"),
    ]


@pytest.mark.parametrize(
    ("name", "hint"),
    [("SILENT", "did you mean lidar.SILENT?"), ("ESTOPP", "did you mean ESTOP?")],
)
def test_an_unknown_name_is_answered_with_the_nearest_among_all(name: str, hint: str) -> None:
    service = AskedService(
        {
            f"POST /errors/{name}/acknowledge": UNKNOWN,
            "GET /errors": {"items": [item("ESTOP"), item("SILENT", "lidar")]},
        }
    )

    with pytest.raises(ServiceProblemError) as unknown:
        acknowledge(service.client(), name)

    assert unknown.value.problem["hint"].endswith(hint)


def test_a_rejection_is_handed_on() -> None:
    refused = httpx.Response(409, json={"code": "REFUSED", "detail": "not now"})
    service = AskedService({"POST /errors/ESTOP/acknowledge": refused})

    with pytest.raises(ServiceProblemError, match="not now"):
        acknowledge(service.client(), "ESTOP")


def test_an_error_of_a_device_is_found_by_its_name() -> None:
    unknown = httpx.Response(404, json={"code": "UNKNOWN_PART", "detail": "no such part"})
    service = AskedService(
        {
            "GET /systems/arm": unknown,
            "GET /nodes/arm": unknown,
            "GET /systems": {"items": []},
            "GET /nodes": {"items": []},
            "GET /devices": {"items": [{"device": "arm"}]},
            "POST /devices/arm/errors/LOST/acknowledge": {},
        }
    )

    acknowledge(service.client(), "arm.LOST")

    assert [path for _, path, *_ in service.writes] == ["/devices/arm/errors/LOST/acknowledge"]


def test_where_there_is_no_such_device_either_the_parts_are_named() -> None:
    unknown = httpx.Response(404, json={"code": "UNKNOWN_PART", "detail": "no such part"})
    service = AskedService(
        {
            "GET /systems/arm": unknown,
            "GET /nodes/arm": unknown,
            "GET /systems": {"items": [{"name": "robot"}]},
            "GET /nodes": {"items": []},
            "GET /devices": {"items": []},
        }
    )

    with pytest.raises(ServiceProblemError, match="no system or node 'arm'"):
        acknowledge(service.client(), "arm.LOST")
