"""What is told of a change."""

import io
import json
from typing import Any

import pytest

from api.cli import change_report
from api.cli.change_report import FEW_NODES, JsonReport, TextReport, is_large
from api.cli.terminal_line import TerminalLine


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def step(number: int, status: str, error: str | None = None) -> dict[str, Any]:
    return {"node": f"node_{number}", "action": "activate", "status": status, "error": error}


def change(done: int, of: int, *more: dict[str, Any], status: str = "running") -> dict[str, Any]:
    steps = [step(number, "succeeded" if number < done else "pending") for number in range(of)]
    return {"id": "c1", "status": status, "reason": None, "steps": [*steps, *more]}


@pytest.fixture
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(change_report, "_LINE_EVERY_S", 0.0)


def test_of_few_nodes_each_step_is_told() -> None:
    said: list[str] = []
    assert not is_large(change(0, FEW_NODES))

    TextReport(said.append).show(change(FEW_NODES, FEW_NODES))

    assert len(said) == FEW_NODES


@pytest.mark.usefixtures("patient")
def test_of_many_nodes_it_is_told_how_many_have_arrived_and_the_final_state() -> None:
    said: list[str] = []
    report = TextReport(said.append)

    for done in (0, 312, 312, 1_000):
        report.show(change(done, 1_000))
    report.end("robot", change(1_000, 1_000, status="succeeded"), "active.FAST")

    assert said == [
        "0 of 1,000 nodes",
        "312 of 1,000 nodes",
        "1,000 of 1,000 nodes",
        "1,000 of 1,000 nodes",
        "robot: succeeded; it is active.FAST now",
    ]


def test_without_a_terminal_a_count_is_told_now_and_then() -> None:
    said: list[str] = []
    report = TextReport(said.append)

    for done in range(1_000):
        report.show(change(done, 1_000))

    assert said[0] == "0 of 1,000 nodes"
    assert len(said) < 50


def test_on_a_terminal_the_count_overwrites_itself() -> None:
    said: list[str] = []
    terminal = Terminal()
    report = TextReport(said.append, TerminalLine(terminal, period_s=0.0))

    report.show(change(1, 1_000))
    report.show(change(2, 1_000))
    report.end("robot", change(1_000, 1_000, status="succeeded"), "active.FAST")

    assert "\r\x1b[2K2 of 1,000 nodes" in terminal.getvalue()
    assert said == ["1,000 of 1,000 nodes", "robot: succeeded; it is active.FAST now"]


def test_steps_that_fail_are_told_one_by_one_up_to_some() -> None:
    said: list[str] = []
    report = TextReport(said.append)
    faults = [step(number, "failed", "no answer") for number in range(100, 115)]
    failed = {**change(100, 100, *faults, status="failed"), "reason": "node_100 failed"}

    report.show(failed)
    report.end("robot", failed, "active")

    assert said[0] == "activate node_100: failed: no answer"
    assert sum("no answer" in line for line in said) == 10
    assert said[-3:] == [
        "5 more steps failed",
        "100 of 115 nodes",
        "robot: failed: node_100 failed; it is active now",
    ]


def test_programs_get_the_change_as_it_ended() -> None:
    said: list[str] = []
    report = JsonReport(said.append)

    report.show(change(0, 2))
    report.end("robot", change(2, 2, status="succeeded"), "")

    assert [json.loads(line)["status"] for line in said] == ["succeeded"]


def test_programs_get_a_change_that_goes_on_as_it_is() -> None:
    said: list[str] = []

    JsonReport(said.append).give_up(change(1, 2), "not ended within 1 s")

    assert json.loads(said[0])["status"] == "running"
