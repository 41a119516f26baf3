"""Names that only the service knows."""

import argparse
from collections.abc import Callable
from typing import Any

import pytest

from api.cli import completers
from api.client import bare_request
from api.client.bare_request import Answer
from api.client.outcomes import NoAnswerError

BODIES: dict[str, Any] = {
    "/systems": {"items": [{"name": "actuation"}]},
    "/nodes": {"items": [{"name": "left/arm"}]},
    "/systems/left/arm/modes": {"code": "UNKNOWN_PART"},
    "/nodes/left/arm/modes": {"items": [{"mode": "FAST"}, {"mode": "SLOW"}]},
    "/signals": {"items": [{"signal": "estop"}]},
    "/holds": {"items": [{"owner": "operator"}]},
    "/errors?open=true": {"items": [{"error": "SILENT", "part": "lidar"}]},
}


@pytest.fixture(autouse=True)
def _service(monkeypatch: pytest.MonkeyPatch) -> None:
    def ask(_: object, __: str, path: str, ___: float) -> Answer:
        return Answer(200, BODIES[path], is_volatile=False)

    monkeypatch.setattr(bare_request, "bare_request", ask)


def offered(offer: Callable[[argparse.Action], None], **options: str) -> list[str]:
    action = argparse.ArgumentParser().add_argument("name")
    offer(action)
    asked = argparse.Namespace(url="http://robot", **options)
    names: list[str] = action.completer(prefix="", action=action, parsed_args=asked)  # type: ignore[attr-defined]
    return names


@pytest.mark.parametrize(
    ("offer", "names"),
    [
        (completers.part_names, ["actuation", "left/arm"]),
        (completers.signal_names, ["estop"]),
        (completers.hold_owners, ["operator"]),
        (completers.open_error_names, ["lidar.SILENT"]),
    ],
)
def test_names_are_those_of_the_service(
    offer: Callable[[argparse.Action], None], names: list[str]
) -> None:
    assert offered(offer) == names


def test_modes_are_those_of_the_part_that_is_named_before() -> None:
    assert offered(completers.mode_names, part="/left/arm") == ["FAST", "SLOW"]


def test_without_an_answer_there_are_none(monkeypatch: pytest.MonkeyPatch) -> None:
    def ask(*_: object) -> Answer:
        raise NoAnswerError("nobody")

    monkeypatch.setattr(bare_request, "bare_request", ask)

    assert offered(completers.part_names) == []
