"""The other computers of the robot at the command line."""

import json
from typing import Any

import httpx
import pytest

from api.cli.command_line import main
from api.cli.commands import command, devices
from api.client.address import Address
from api.client.service_client import ServiceClient
from tests.support.monitor import device, this_device

Output = pytest.CaptureFixture[str]

BASE = device("base", heard_age_s=0.07)
ARM = device(
    "arm",
    "lost",
    heard_age_s=12.4,
    reason="nothing was heard for 1.5 s",
    parts=["arm", "gripper"],
    offline={"after_s": 3.5, "target": {}, "reactions": False},
    stops=["arm-7"],
)


class Service:
    """A service that has some devices, or is one."""

    def __init__(self) -> None:
        self.items: list[Any] = []
        self.this: Any = None

    def answer(self, request: httpx.Request) -> httpx.Response:
        assert request.url.path == "/devices"
        return httpx.Response(200, json={"items": self.items, "this": self.this})


@pytest.fixture
def service(monkeypatch: pytest.MonkeyPatch) -> Service:
    service = Service()
    transport = httpx.MockTransport(service.answer)

    def with_service(url: str, run: Any) -> int:  # noqa: ANN401
        client = ServiceClient(Address.of(url), transport)
        return command.answered(lambda: run(client))

    monkeypatch.setattr(devices, "with_service", with_service)
    return service


def test_devices_are_listed_with_what_each_does_when_it_is_cut_off(
    service: Service, capsys: Output
) -> None:
    service.items = [BASE, ARM]

    assert main(["devices"]) == 1
    assert capsys.readouterr().out.splitlines() == [
        "device  state      heard     parts         when cut off                       stops",
        "base    connected  now       drive_base    after 2 s: drive_base to inactive  none",
        "arm     lost       12 s ago  arm, gripper  stays as it is                     arm-7",
        "  nothing was heard for 1.5 s",
    ]


def test_where_all_are_connected_the_exit_code_says_so(service: Service) -> None:
    service.items = [BASE]

    assert main(["devices"]) == 0


@pytest.mark.parametrize("state", ["late", "lost", "conflict", "never_seen"])
def test_a_device_that_is_not_connected_is_told_by_the_exit_code_too(
    service: Service, state: str
) -> None:
    service.items = [BASE, {**ARM, "state": state, "heard_age_s": None}]

    assert main(["devices"]) == 1


def test_one_that_acts_alone_says_so(service: Service, capsys: Output) -> None:
    reacts = {"after_s": 2.0, "target": {"drive_base": "inactive"}, "reactions": True}
    service.items = [{**BASE, "autonomous": True, "offline": reacts}]

    main(["devices"])

    row = capsys.readouterr().out.splitlines()[1]
    assert "connected, acts alone" in row
    assert "after 2 s: drive_base to inactive, its reactions act" in row


def test_a_robot_of_one_computer_has_none(service: Service, capsys: Output) -> None:
    assert main(["devices"]) == 0
    assert capsys.readouterr().out == "no devices: the robot has one computer\n"


@pytest.mark.parametrize(
    ("lead", "code", "words"),
    [
        ("supervisor", 0, "device arm: the supervisor's word counts"),
        ("nobody", 1, "device arm: no supervisor yet"),
        ("cut_off", 1, "device arm: cut off"),
        ("device", 1, "device arm: acts alone"),
    ],
)
def test_a_device_itself_says_whose_word_counts(
    service: Service, capsys: Output, lead: str, code: int, words: str
) -> None:
    service.this = this_device("arm", lead)

    assert main(["devices"]) == code
    assert capsys.readouterr().out.splitlines() == [
        words,
        "when cut off: after 2 s: drive_base to inactive",
    ]


def test_they_are_written_as_json(service: Service, capsys: Output) -> None:
    service.items = [BASE]

    main(["devices", "--format", "json"])

    assert json.loads(capsys.readouterr().out) == {"items": [BASE], "this": None}
