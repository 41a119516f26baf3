"""Acknowledging at the command line."""

import json

import pytest

from api.cli.command_line import main
from tests.support.asked_service import AskedService
from tests.unit.api.cli.test_error_lines import item

Output = pytest.CaptureFixture[str]

LOW = item("BATTERY_LOW")
RETURNED = item("SILENT", "lidar", state="returned")
SEEN = item("ESTOP", state="acknowledged")
OPEN = "GET /errors?open=true"


@pytest.fixture
def service(monkeypatch: pytest.MonkeyPatch) -> AskedService:
    service = AskedService(
        {
            OPEN: {"items": [LOW, RETURNED, SEEN]},
            "GET /systems/lidar": {"name": "lidar"},
            "POST /errors/BATTERY_LOW/acknowledge": {},
            "POST /systems/lidar/errors/SILENT/acknowledge": {},
        }
    )
    service.stand_in(monkeypatch)
    return service


def test_without_a_name_what_waits_is_listed(service: AskedService, capsys: Output) -> None:
    assert main(["ack"]) == 1

    told = capsys.readouterr().out
    assert "BATTERY_LOW" in told
    assert "lidar.SILENT" in told
    assert "ESTOP" not in told
    assert not service.writes


def test_where_nothing_waits_that_is_told(service: AskedService, capsys: Output) -> None:
    service.answers[OPEN] = {"items": [SEEN]}

    assert main(["ack"]) == 0
    assert main(["ack", "--all"]) == 0
    assert capsys.readouterr().out == "no error waits for it\n" * 2


def test_errors_are_acknowledged_by_their_names(service: AskedService, capsys: Output) -> None:
    service.answers[OPEN] = {"items": [{**LOW, "state": "acknowledged"}]}

    assert main(["ack", "BATTERY_LOW", "lidar.SILENT"]) == 0

    assert [path for _, path, _ in service.writes] == [
        "/errors/BATTERY_LOW/acknowledge",
        "/systems/lidar/errors/SILENT/acknowledge",
    ]
    assert capsys.readouterr().out.splitlines() == [
        "BATTERY_LOW is acknowledged; it ends with its cause",
        "lidar.SILENT is acknowledged; it is over",
    ]


def test_all_that_wait_are_acknowledged(service: AskedService) -> None:
    assert main(["ack", "--all"]) == 0
    assert len(service.writes) == 2


def test_programs_get_json(service: AskedService, capsys: Output) -> None:
    assert main(["ack", "--format", "json"]) == 1
    assert main(["ack", "BATTERY_LOW", "--format", "json"]) == 0

    waiting, done = map(json.loads, capsys.readouterr().out.splitlines())
    assert waiting == {"items": [LOW, RETURNED]}
    assert done == {"items": [LOW]}
    assert service.writes
