"""Reactions at the command line."""

import json
from typing import Any

import httpx
import pytest

from api.cli.command_line import main
from api.cli.commands import command, reactions
from api.client.address import Address
from api.client.service_client import ServiceClient

LIMP = {
    "reaction": "LIMP",
    "part": "left/arm",
    "arm": "active",
    "state": "idle",
    "action": "mode",
    "target": {"state": "active", "mode": "SLOW"},
    "waits_for": "temperature > 40",
}
HALT = {**LIMP, "reaction": "HALT", "action": "hold", "target": None}


class Service:
    """A service that has some reactions, and notes what it is asked."""

    def __init__(self) -> None:
        self.items: list[dict[str, Any]] = [LIMP, HALT]
        self.writes: list[tuple[str, str, Any]] = []

    def answer(self, request: httpx.Request) -> httpx.Response:
        path = str(request.url.raw_path, "ascii")
        if request.method != "GET":
            body = json.loads(request.content) if request.content else None
            self.writes.append((request.method, path, body))
        return httpx.Response(200, json={"items": self.items})


@pytest.fixture
def service(monkeypatch: pytest.MonkeyPatch) -> Service:
    service = Service()
    transport = httpx.MockTransport(service.answer)

    def with_service(url: str, run: Any) -> int:  # noqa: ANN401
        client = ServiceClient(Address.of(url), transport)
        return command.answered(lambda: run(client))

    monkeypatch.setattr(reactions, "with_service", with_service)
    return service


Output = pytest.CaptureFixture[str]


def test_reactions_are_listed_with_what_they_wait_for(service: Service, capsys: Output) -> None:
    service.items = [LIMP, {**HALT, "arm": "passive"}]

    assert main(["reactions"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "left/arm.LIMP  idle            mode active.SLOW  waits for temperature > 40",
        "left/arm.HALT  idle (passive)  hold              waits for temperature > 40",
    ]


def test_a_reaction_that_acts_is_told_by_the_exit_code_too(service: Service) -> None:
    service.items = [{**LIMP, "state": "acting"}]

    assert main(["reactions"]) == 1


def test_a_robot_without_reactions(service: Service, capsys: Output) -> None:
    service.items = []

    assert main(["reactions"]) == 0
    assert capsys.readouterr().out == "no reactions\n"


def test_they_are_written_as_json(service: Service, capsys: Output) -> None:
    assert main(["reactions", "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"items": [LIMP, HALT]}


def test_a_reaction_is_armed_with_a_reason_and_acknowledged(service: Service) -> None:
    asked = ["--arm", "LIMP=passive", "--reason", "on trial", "--ack", "left/arm.HALT"]

    assert main(["reactions", *asked]) == 0
    assert service.writes == [
        (
            "PATCH",
            "/systems/left/arm/reactions/LIMP",
            {"arm": "passive", "reason": "on trial"},
        ),
        ("POST", "/systems/left/arm/reactions/HALT/acknowledge", None),
    ]


def test_an_unknown_reaction_changes_nothing(service: Service, capsys: Output) -> None:
    assert main(["reactions", "--arm", "LIMP=passive", "--ack", "NONE"]) == 1
    assert capsys.readouterr().err == (
        "rejected: there is no reaction 'NONE'\n  hint: known: LIMP, HALT\n"
    )
    assert service.writes == []


@pytest.mark.parametrize("text", ["LIMP", "LIMP=perhaps", "=passive"])
def test_what_is_no_arming_is_rejected(service: Service, text: str) -> None:
    with pytest.raises(SystemExit) as misuse:
        main(["reactions", "--arm", text])

    assert misuse.value.code == 64
