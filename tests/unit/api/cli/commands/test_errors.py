"""Errors at the command line."""

import json
from typing import Any

import httpx
import pytest

from api.cli.command_line import main
from api.cli.commands import command, errors
from api.client.address import Address
from api.client.service_client import ServiceClient
from tests.unit.api.cli.test_error_lines import item


class Service:
    """A service that has some errors, and notes what it is asked."""

    def __init__(self, *items: dict[str, Any]) -> None:
        self.items = items
        self.asked: list[tuple[str, str, Any]] = []

    def answer(self, request: httpx.Request) -> httpx.Response:
        body = json.loads(request.content) if request.content else None
        self.asked.append((request.method, str(request.url.raw_path, "ascii"), body))
        if request.url.path == "/errors":
            return httpx.Response(200, json={"items": list(self.items)})
        if request.method == "GET" and request.url.path != "/nodes/left/lidar":
            return httpx.Response(404, json={"code": "UNKNOWN_PART", "detail": "no such part"})
        return httpx.Response(204 if request.method == "DELETE" else 200, json={})

    @property
    def writes(self) -> list[tuple[str, str, Any]]:
        return [asked for asked in self.asked if asked[0] != "GET"]


@pytest.fixture
def service(monkeypatch: pytest.MonkeyPatch) -> Service:
    service = Service()
    transport = httpx.MockTransport(service.answer)

    def with_service(url: str, run: Any) -> int:  # noqa: ANN401
        client = ServiceClient(Address.of(url), transport)
        return command.answered(lambda: run(client))

    monkeypatch.setattr(errors, "with_service", with_service)
    return service


def test_a_robot_without_errors_is_fine(
    service: Service, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["errors"]) == 0
    assert capsys.readouterr().out == "no errors\n"
    assert service.asked == [("GET", "/errors?open=true", None)]


def test_an_error_that_is_on_is_told_by_the_exit_code_too(
    service: Service, capsys: pytest.CaptureFixture[str]
) -> None:
    service.items = (item("SILENT", "lidar"),)
    assert main(["errors", "--part", "lidar"]) == 1
    assert "lidar.SILENT: it is so" in capsys.readouterr().out
    assert service.asked == [("GET", "/errors?open=true&part=lidar", None)]


def test_an_error_that_returned_is_listed_and_not_on(service: Service) -> None:
    service.items = (item("SILENT", "lidar", state="returned"),)
    assert main(["errors"]) == 0


def test_programs_get_json(service: Service, capsys: pytest.CaptureFixture[str]) -> None:
    service.items = (item("ESTOP"),)
    main(["errors", "--format", "json"])
    assert json.loads(capsys.readouterr().out)["items"][0]["error"] == "ESTOP"


def test_errors_are_acknowledged_by_their_names(service: Service) -> None:
    assert main(["errors", "--ack", "ESTOP", "--ack", "left/lidar.SILENT"]) == 0
    assert service.writes == [
        ("POST", "/errors/ESTOP/acknowledge", None),
        ("POST", "/nodes/left/lidar/errors/SILENT/acknowledge", None),
    ]


def test_an_error_is_shelved_for_a_time_with_a_reason(service: Service) -> None:
    asked = ["errors", "--shelve", "ESTOP", "--for", "1.5h", "--reason", "known"]
    assert main(asked) == 0
    assert service.writes == [("PUT", "/errors/ESTOP/shelf", {"for_s": 5_400, "reason": "known"})]


def test_an_error_is_taken_off_the_shelf(service: Service) -> None:
    assert main(["errors", "--unshelve", "ESTOP"]) == 0
    assert service.writes == [("DELETE", "/errors/ESTOP/shelf", None)]


def test_an_unknown_part_is_refused(service: Service) -> None:
    assert main(["errors", "--ack", "nobody.SILENT"]) == 1
    assert not service.writes


@pytest.mark.parametrize(
    ("text", "time_s"), [("90", 90), ("90s", 90), ("10min", 600), ("8h", 28_800)]
)
def test_a_time_has_a_unit(text: str, time_s: float) -> None:
    assert command.span(text) == time_s


@pytest.mark.parametrize("text", ["", "soon", "5 d", "10m"])
def test_another_unit_is_refused(text: str) -> None:
    with pytest.raises(SystemExit):
        main(["errors", "--shelve", "ESTOP", "--for", text])
