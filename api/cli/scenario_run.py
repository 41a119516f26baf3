"""`pilothouse simulate`: runs a scenario in virtual time, and checks its expectations."""

import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

from api.cli.terminal_line import TerminalLine
from api.http.schemas.base import BlockerJson
from api.http.schemas.simulation import DifferenceJson, ExpectationJson, RefusalJson
from api.simulation.expectations import MISSING
from api.simulation.scenario_file import InvalidScenarioError, Scenario, load_scenario
from api.simulation.simulation import Simulation
from api.terminal_text import finding_line
from service.files.text_file import UnreadableFileError, read_text_file
from service.worker import TooComplexError

HELD, FAILED, INVALID = 0, 1, 2


def simulate(
    name: str,
    form: Literal["text", "json"],
    loaded_model: Path,
    model: Path | None = None,
    robot: Path | None = None,
) -> int:
    """Run a scenario and print the results; return the exit code.

    Args:
        name: Path of the scenario; `-` is the standard input.
        form: `text` for people, `json` for programs.
        loaded_model: File of the default model.
        model: Model file that replaces the model of the scenario.
        robot: Robot file that replaces the settings of the scenario.
    """
    try:
        scenario = load_scenario(name, read_text_file(loaded_model), model, robot)
        simulation = Simulation(scenario.body, scenario.robot)
        begin = time.perf_counter()
        _run(simulation, scenario.body.until_s)
        took_s = time.perf_counter() - begin
    except InvalidScenarioError as error:
        for file, finding in error.findings:
            print(finding_line(file, finding), file=sys.stderr)
        return INVALID
    except (UnreadableFileError, TooComplexError) as error:
        print(f"pilothouse: {error}", file=sys.stderr)
        return INVALID
    if form == "json":
        print(simulation.as_json())
    else:
        for line in report(scenario, simulation, took_s):
            print(line)
    return FAILED if failures(scenario, simulation) else HELD


def failures(scenario: Scenario, simulation: Simulation) -> list[str]:
    """Return lines on unmet expectations and unexpected rejections; empty if there are none."""
    found: list[ExpectationJson | RefusalJson] = [
        *simulation.failed_expectations(),
        *simulation.unexpected_refusals(),
    ]
    return [
        line
        for item in sorted(found, key=lambda item: (item.t_s, item.step))
        for line in _failure(scenario, item)
    ]


def report(scenario: Scenario, simulation: Simulation, took_s: float) -> Iterator[str]:
    """Yield the results of a scenario, line by line.

    Args:
        scenario: The scenario.
        simulation: Its simulation, after the run.
        took_s: Duration of the run, s.
    """
    if scenario.body.title:
        yield scenario.body.title
    for event in simulation.events:
        if event.event.notable:
            yield f"{simulation.seconds_to(event):9.2f} s  {event.event.words}"
    failed = failures(scenario, simulation)
    yield from failed
    speed = f"{scenario.body.until_s:g} s in {took_s:.2f} s"
    yield f"{scenario.file}: {_verdict(simulation)} ({speed})"


def _run(simulation: Simulation, until_s: float) -> None:
    """Run with a progress line if the standard error is a terminal."""
    with TerminalLine(sys.stderr) as line:

        def show(at_s: float) -> None:
            share = at_s / until_s if until_s else 1.0
            line.show(f"{at_s:,.1f} s of {until_s:,g} s ({share:.0%})")

        simulation.run(show if line.is_shown else lambda _: None)


def _failure(scenario: Scenario, item: ExpectationJson | RefusalJson) -> Iterator[str]:
    """Yield the lines on one failure."""
    if isinstance(item, RefusalJson):
        place = f"{scenario.file}:{scenario.line_of(item.step)}"
        yield f"{place}: rejected at {item.t_s:g} s: {item.problem.detail}"
        if item.problem.hint:
            yield f"    hint: {item.problem.hint}"
        return
    for difference in item.differences:
        if item.blockers:
            place = f"{scenario.file}:{scenario.line_of(item.step)}"
            yield f"{place}: {difference.seen} at {item.t_s:g} s: {difference.expected}"
            for blocker in item.blockers:
                # The line above says already which conditions are joined.
                is_joined = blocker.causes and blocker.threshold is None
                for reason in blocker.causes if is_joined else (blocker,):
                    yield from _tree(reason, 1)
        elif difference.path == "refused":
            place = f"{scenario.file}:{scenario.line_of(item.step)}"
            yield f"{place}: not rejected at {item.t_s:g} s, although that was expected"
        else:
            yield from _difference(scenario, item, difference)


def _tree(blocker: BlockerJson, depth: int) -> Iterator[str]:
    """Yield a reason, and below it what it follows from."""
    yield f"{'    ' * depth}{blocker.message}"
    for cause in blocker.causes:
        yield from _tree(cause, depth + 1)


def _difference(
    scenario: Scenario, item: ExpectationJson, difference: DifferenceJson
) -> Iterator[str]:
    line = scenario.line_of(item.step, difference.path)
    yield f"{scenario.file}:{line}: not as expected at {item.t_s:g} s: {difference.path}"
    yield f"    expected {_shown(difference.expected)}"
    yield f"    actual   {_shown(difference.seen)}"


_LONGEST = 300


def _shown(value: object) -> str:
    text = MISSING if value == MISSING else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


def _verdict(simulation: Simulation) -> str:
    held = sum(not found.differences for found in simulation.expectations)
    failed = len(simulation.expectations) - held
    refused = len(simulation.unexpected_refusals())
    if not simulation.expectations and not refused:
        return "no expectations"
    counts = [(held, "as expected"), (failed, "not as expected"), (refused, "rejected")]
    return ", ".join(f"{count} {what}" for count, what in counts if count)
