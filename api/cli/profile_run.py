"""`pilothouse profile`: measures, keeps the raw data, and reports."""

import asyncio
import json
import signal
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from random import Random
from typing import Any, Literal

from api.cli.terminal_line import TerminalLine
from api.client.outcomes import Json
from api.distribution import installed_version
from api.profiling.live_robot import NotSimulatedError, live_robot
from api.profiling.machine import load_facts, machine_facts
from api.profiling.own_service import NotServingError, own_service
from api.profiling.plot import NoMatplotlibError, check_plot, draw
from api.profiling.profile import Progress, measure_runs
from api.profiling.report import report_json, report_lines
from api.profiling.robot import LostServiceError, Robot
from api.profiling.run_file import InvalidRunFileError, Run, RunWriter, read_runs
from api.profiling.triggers import TRIGGERS, changed_settings
from api.terminal_text import complain

SUCCEEDED, FAILED, MISUSED = 0, 1, 2

_MOCK_OFF = "# Readings come from the profile.\nmock: false\n"
_RUNS, _SETUP = "runs.csv", "setup.json"
_DECISIVE = frozenset({"version", "machine", "changed_settings"})
"""Where profiles differ in these, they have no setup together."""
_SHOWN = _DECISIVE | {"started_at", "load"}
"""What a report shows of a setup."""
_LINE_EVERY_S = 30.0
"""Between two lines of progress, where there is no terminal."""


@dataclass(frozen=True, slots=True)
class ProfileOptions:
    """Options of `pilothouse profile`."""

    model: Path | None
    robot: Path | None
    runs: int
    triggers: tuple[str, ...]
    """Errors."""
    out: Path | None
    form: Literal["text", "json"]
    plot: bool


class _MisusedError(Exception):
    """What was asked for cannot be done; the message says why."""


def measure(options: ProfileOptions) -> int:
    """Measure, report, and return the exit code.

    Raises:
        KeyboardInterrupt: It was interrupted; what was measured is kept and reported.
    """
    out = options.out or Path(f"profile-{datetime.now(UTC):%Y%m%d-%H%M%S}")
    runs: list[Run] = []
    why = ""
    is_interrupted = False
    try:
        if options.plot:
            check_plot()
        with _new_file(out).open("w", encoding="utf-8", newline="") as file:
            try:
                serve = _serve_options(options, out)
                asyncio.run(_measure(options, serve, out, RunWriter(file), runs))
            except (NotServingError, NotSimulatedError, LostServiceError) as error:
                why = str(error)
            except (KeyboardInterrupt, asyncio.CancelledError):
                is_interrupted = True
        _report(runs, _setup_of([out / _RUNS]), out, options.form, plot=options.plot)
    except (_MisusedError, NoMatplotlibError, OSError) as error:
        return _misused(error)
    print(f"pilothouse: results are in {out}", file=sys.stderr)
    if why:
        complain(why)
    if is_interrupted:
        raise KeyboardInterrupt
    return FAILED if why else _code(runs)


def analyse(
    files: Sequence[Path], out: Path | None, form: Literal["text", "json"], *, plot: bool
) -> int:
    """Make the report of earlier profiles, and return the exit code.

    Args:
        files: Raw data; runs of the same trigger are taken together.
        out: Folder for the report; None: it is only printed.
        form: Of the printed report.
        plot: Draw the distributions as well.
    """
    try:
        if plot and out is None:
            raise _MisusedError("--plot with --analyse needs --out, the folder of the picture")
        runs = [run for file in files for run in read_runs(file)]
        if out is not None:
            out.mkdir(parents=True, exist_ok=True)
        _report(runs, _setup_of(files), out, form, plot=plot)
    except (_MisusedError, InvalidRunFileError, NoMatplotlibError, OSError) as error:
        return _misused(error)
    return _code(runs)


def _misused(error: Exception) -> int:
    """Say why nothing can be done.

    Raises:
        OSError: It is not about a file, but about what is printed.
    """
    if isinstance(error, OSError):
        if error.filename is None:
            raise error
        complain(f"{error.filename}: {error.strerror}")
    else:
        complain(str(error))
    return MISUSED


def _serve_options(options: ProfileOptions, out: Path) -> list[str]:
    """Return model, robot file and folder of the service; without a robot file, one is written."""
    robot_file = options.robot
    if robot_file is None:
        robot_file = out / "robot.yaml"
        robot_file.write_text(_MOCK_OFF, encoding="utf-8")
    model = [str(options.model)] if options.model else []
    # On a disk, as on a robot: what storing costs is part of what is measured.
    return [*model, "--robot", str(robot_file), "--data", str(out / "data")]


async def _measure(
    options: ProfileOptions, serve: Sequence[str], out: Path, writer: RunWriter, runs: list[Run]
) -> None:
    """Measure with a service of its own; each run is kept when it has ended."""
    _end_by_signals()

    def keep(run: Run) -> None:
        runs.append(run)
        writer.write(run)

    triggers = [TRIGGERS[error] for error in options.triggers]
    with TerminalLine(sys.stderr, period_s=0) as line:
        async with own_service(serve, out / "service.log") as url, live_robot(url) as robot:
            _write_json(out / _SETUP, _setup(options, robot))
            progress = _Progress(line)
            await measure_runs(robot, triggers, options.runs, Random(), keep, progress.show)


def _end_by_signals() -> None:
    """Let SIGTERM and SIGHUP end the measurement as Ctrl-C does, and with it the service."""
    task, loop = asyncio.current_task(), asyncio.get_running_loop()
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if task and number and signal.getsignal(number) is not signal.SIG_IGN:
            # NotImplementedError: there are no such handlers on Windows.
            with suppress(NotImplementedError):
                loop.add_signal_handler(number, task.cancel)


class _Progress:
    """Shows how far a profile is: on a terminal in one line, elsewhere in a line now and then."""

    def __init__(self, line: TerminalLine) -> None:
        self._line = line
        self._next_at = time.monotonic()

    def show(self, progress: Progress) -> None:
        """Show it."""
        minutes, seconds = divmod(round(progress.left_s), 60)
        text = (
            f"run {progress.done + 1} of {progress.total}: {progress.trigger},"
            f" {minutes}:{seconds:02} min left"
        )
        if self._line.is_shown:
            self._line.show(text)
        elif time.monotonic() >= self._next_at:
            self._next_at = time.monotonic() + _LINE_EVERY_S
            print(text, file=sys.stderr, flush=True)


def _new_file(out: Path) -> Path:
    """Return where the raw data goes; the folder is made, and no earlier data overwritten.

    Raises:
        _MisusedError: The folder holds a profile.
        OSError: It cannot be made.
    """
    file = out / _RUNS
    if file.exists():
        raise _MisusedError(f"{file} exists, and would be overwritten; choose another --out")
    out.mkdir(parents=True, exist_ok=True)
    return file


def _setup(options: ProfileOptions, robot: Robot) -> Json:
    """Return how and where it is measured."""
    return {
        "version": installed_version(),
        "started_at": datetime.now(UTC).isoformat(timespec="seconds").replace("+00:00", "Z"),
        "machine": machine_facts(),
        "load": load_facts(),
        "model": str(options.model) if options.model else None,
        "robot": str(options.robot) if options.robot else None,
        "changed_settings": list(changed_settings(robot.settings)),
        "settings": robot.settings,
    }


def _setup_of(files: Sequence[Path]) -> Json:
    """Return the setup beside raw data; empty if it is not known, or files differ in it.

    The load is left out where there are several: it is another one each time.
    """
    found: list[dict[str, Any]] = []
    for file in files:
        try:
            setup = json.loads((file.parent / _SETUP).read_text(encoding="utf-8"))
        except (FileNotFoundError, ValueError):
            return {}
        if not isinstance(setup, dict) or not _SHOWN.issubset(setup):
            return {}
        found.append(setup)
    is_same = all(other[key] == found[0][key] for other in found for key in _DECISIVE)
    if not is_same:
        return {}
    return found[0] if len(found) == 1 else {**found[0], "load": {}}


def _report(
    runs: Sequence[Run],
    setup: Json,
    out: Path | None,
    form: Literal["text", "json"],
    *,
    plot: bool,
) -> None:
    """Store the report, and print it.

    Raises:
        OSError: It cannot be stored.
        NoMatplotlibError: It was to be drawn, and matplotlib is not installed.
    """
    text = "\n".join(report_lines(runs, setup))
    found = report_json(runs, setup)
    if out is not None:
        (out / "report.txt").write_text(text + "\n", encoding="utf-8")
        _write_json(out / "report.json", found)
        if plot and runs:
            draw(runs, out / "latency.png")
    print(json.dumps(found, indent=2) if form == "json" else text)


def _write_json(file: Path, content: Json) -> None:
    file.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def _code(runs: Sequence[Run]) -> int:
    return SUCCEEDED if runs and all(run.is_ok for run in runs) else FAILED
