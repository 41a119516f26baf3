"""`pilothouse task`: submit the waypoints of a file as a task, and follow its progress."""

import argparse
import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from http import HTTPStatus
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from api.cli.commands.command import Command, add_format, add_url, with_service
from api.cli.task_text import distance_text, status_text
from api.cli.terminal_line import TerminalLine
from api.client.outcomes import Json, Outcome, ServiceProblemError
from api.terminal_text import complain, say

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

_TEXT = """\
Submit the waypoints of a CSV file as a task, which replaces the current one,
and follow it to its end. Each line is x,y or x,y,yaw in m and rad, unless a
header or a # line names the columns, such as s_m, x_m, y_m, psi_rad. Commas,
semicolons, tabs or blanks separate them. --columns names the columns of a file
that does not, and --heading the unit of its headings; --preview says how they
were read.

  pilothouse task track.csv --preview
  pilothouse task track.csv --speed 1.5 --controller stanley
  pilothouse task --cancel

While there are holds, such as during an error, the task waits. After Ctrl-C
the task continues; --cancel cancels it.

exit code: 0 succeeded, or done; 1 rejected, canceled or aborted;
           2 unknown: no answer; or the file cannot be read
"""

_STANDARD_INPUT = Path("/dev/stdin")

Say = Callable[[str], None]

# --- the command line ----------------------------------------------------------------------------


def _add_options(parser: argparse.ArgumentParser) -> None:
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("file", nargs="?", metavar="FILE", help="CSV; - reads standard input")
    what.add_argument("--cancel", action="store_true", help="cancel the current task, and stop")
    parser.add_argument("--controller", metavar="NAME", help="pure_pursuit (default) or stanley")
    parser.add_argument(
        "--speed", type=float, metavar="MPS", help="cruise speed in m/s; default: 2.8"
    )
    parser.add_argument(
        "--heading",
        choices=("rad", "deg", "compass", "rad_north", "rad_compass"),
        help="unit of the headings: rad or deg, counter-clockwise from east; compass: degrees"
        " clockwise from north; rad_north, rad_compass: radians from north; default: what fits",
    )
    parser.add_argument(
        "--columns",
        metavar="NAMES",
        help="names of the columns, such as s,x,y,yaw; _ is any other",
    )
    parser.add_argument(
        "--start-index", type=int, metavar="N", help="waypoint to start with; default: 0"
    )
    parser.add_argument("--preview", action="store_true", help="show the preview, submit nothing")
    parser.add_argument(
        "--wait",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="follow the task to its end (default), or only submit it",
    )
    add_format(parser, "json: the task as it ended, or the preview")
    add_url(parser)


def _run(options: argparse.Namespace) -> int:
    if options.cancel:
        return with_service(options.url, lambda client: cancel(client, options.format, say))
    asked = TaskOptions(
        file=options.file,
        controller=options.controller,
        speed_mps=options.speed,
        heading=options.heading,
        columns=options.columns,
        start_index=options.start_index,
        preview=options.preview,
        wait=options.wait,
        is_json=options.format == "json",
    )
    return with_service(options.url, lambda client: run_task(client, asked, say))


COMMAND = Command("task", "submit or cancel a waypoint task", _TEXT, _add_options, _run)

# --- what it does --------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class TaskOptions:
    """Options of a task; None: the service's default."""

    file: str
    """Path of a CSV file; `-` is standard input."""
    controller: str | None = None
    speed_mps: float | None = None
    heading: str | None = None
    """`rad`, `deg` or `compass`."""
    columns: str | None = None
    """Names of the columns, separated by commas."""
    start_index: int | None = None
    preview: bool = False
    """Only show the preview; submit nothing."""
    wait: bool = True
    """Follow the task to its end."""
    is_json: bool = False
    """Print only the preview, or the task as it ended."""

    @property
    def query(self) -> dict[str, str | int | float]:
        """Return the query parameters that go with the CSV."""
        given = {
            "controller": self.controller,
            "speed_mps": self.speed_mps,
            "heading": self.heading,
            "columns": self.columns,
            "start_index": self.start_index,
        }
        return {name: value for name, value in given.items() if value is not None}


def run_task(
    client: "ServiceClient",
    asked: TaskOptions,
    say: Say,
    complaints: TextIO | None = None,
) -> Outcome:
    """Preview a task, submit it, and follow it to its end.

    Args:
        client: Sends requests to the service.
        asked: The waypoint file, and the options of the task.
        say: Prints a line.
        complaints: Stream for invalid waypoints and the progress line; None: standard error.

    Raises:
        ServiceProblemError: The task was rejected, and not because of its waypoints.
        NoAnswerError: The service did not answer; whether the task was submitted, or how it ended,
            is unknown.
    """
    err: TextIO = complaints or sys.stderr
    text = _text_of(asked.file, err)
    if text is None:
        # The exit code of all commands for this.
        return Outcome.UNKNOWN
    try:
        found = client.call("POST", "/tasks/preview", csv=text, query=asked.query)
        for line in () if asked.is_json else preview_lines(asked.file, found):
            say(line)
        if asked.preview and asked.is_json:
            say(json.dumps(found))
        if asked.preview:
            return Outcome.SUCCEEDED
        return _drive(client, asked, text, say, err)
    except ServiceProblemError as error:
        if not error.problem.get("findings"):
            raise ServiceProblemError(_in_options(error.problem)) from error
        for line in fault_lines(asked.file, text, error.problem):
            print(line, file=err)
        return Outcome.FAILED


def _drive(
    client: "ServiceClient", asked: TaskOptions, text: str, say: Say, complaints: TextIO
) -> Outcome:
    """Submit a task and follow it to its end; Ctrl-C leaves it, and says so."""
    # Loaded late for a quick `--help`, since it needs asyncio and websockets; and before the task
    # is submitted, so that Ctrl-C in between is not missed.
    from api.cli.task_follower import REDRAW_S, follow_task

    name = "the task, if it was submitted,"
    try:
        task = client.call("POST", "/tasks", csv=text, query=asked.query)
        name = f"task {task['id']}"
        if not asked.wait:
            say(json.dumps(task) if asked.is_json else f"{name} is started: {status_text(task)}")
            return Outcome.SUCCEEDED
        with TerminalLine(complaints, REDRAW_S) as progress:
            outcome = follow_task(client, task, _silent if asked.is_json else say, progress)
        if asked.is_json:
            say(json.dumps(client.call("GET", f"/tasks/{task['id']}")))
        return outcome
    except KeyboardInterrupt:
        tell = complain if asked.is_json else say
        tell(f"{name} goes on; to cancel it: {_cancel_command(client)}")
        raise


def _silent(_: str) -> None:
    """Tell nothing."""


def _text_of(file: str, complaints: TextIO) -> str | None:
    """Return the text of a file; None: it cannot be read, and the reason was printed."""
    from service.files.text_file import UnreadableFileError, decode_csv, read_bytes

    try:
        return decode_csv(read_bytes(_STANDARD_INPUT if file == "-" else Path(file)))
    except UnreadableFileError as error:
        print(f"pilothouse: {error}", file=complaints)
        return None


def cancel(client: "ServiceClient", how: str, say: Say) -> Outcome:
    """Cancel the current task.

    Args:
        client: The service.
        how: `text` or `json`.
        say: Prints a line.

    Raises:
        ServiceProblemError: The request was rejected.
        NoAnswerError: The service did not answer.
    """
    try:
        task = client.call("GET", "/tasks/current")
    except ServiceProblemError as error:
        if error.problem.get("status") != HTTPStatus.NOT_FOUND:
            raise
        say(json.dumps({"task": None}) if how == "json" else "there is no task to cancel")
        return Outcome.SUCCEEDED
    client.call("DELETE", "/tasks/current")
    ended = client.call("GET", f"/tasks/{task['id']}")
    words = f"task {ended['id']} after {distance_text(ended)}: {status_text(ended)}"
    say(json.dumps({"task": ended}) if how == "json" else words)
    return Outcome.SUCCEEDED


def preview_lines(file: str, found: Json) -> Iterator[str]:
    """Yield the preview of a task.

    Args:
        file: Name of the waypoint file.
        found: The response to `POST /tasks/preview`.
    """
    count, length_m = found["waypoint_count"], found["length_m"]
    read = found.get("csv")
    yield f"{file}: {count} waypoints, {length_m:.1f} m, some {found['duration_s']:.0f} s"
    if read is not None:
        yield f"  {read['message']}"
    radius_m = found["min_radius_m"]
    if radius_m is None:
        yield "  straight"
    else:
        least = f"the vehicle can steer {found['vehicle_min_radius_m']:.1f} m"
        yield f"  tightest radius {radius_m:.1f} m ({least})"
    start = found["start"]
    if start is None:
        yield "  it is not known where the vehicle is"
    else:
        off = f"heading off by {abs(degrees(start['heading_error_rad'])):.0f} degrees"
        yield f"  start {start['distance_m']:.1f} m from the vehicle, {off}"
    if (approach := found["approach"]) is not None:
        way = f"{approach['length_m']:.1f} m at {approach['speed_mps']:.1f} m/s"
        yield f"  the vehicle drives onto the path first: {way}"
    for warning in found["warnings"]:
        place = "" if warning["index"] is None else f" (waypoint {warning['index']})"
        yield f"  warning {warning['code']}: {warning['message']}{place}"
        if warning.get("hint"):
            yield f"  hint: {_in_options(warning)['hint']}"


def fault_lines(file: str, text: str, problem: Json) -> Iterator[str]:
    """Yield why waypoints were rejected: each finding with its line, and a hint.

    Args:
        file: Name of the waypoint file.
        text: Content of the file.
        problem: The problem document of the response.
    """
    from service.files.text_file import lines_of

    lines = lines_of(text)
    for finding in problem["findings"]:
        number, column = finding["line"] or 1, finding["column"] or 1
        yield f"{file}:{number}:{column}: {finding['code']} {finding['message']}"
        if number <= len(lines) and lines[number - 1].strip():
            yield f"    {lines[number - 1].rstrip()[:100]}"
    yield "rejected: nothing was started"
    if problem.get("hint"):
        yield f"  hint: {_in_options(problem)['hint']}"


def _in_options(problem: Json) -> Json:
    """Return the problem with a hint that names command line options instead of parameters."""
    hint = problem.get("hint") or ""
    options = (
        ("?heading=", "--heading "),
        ("?columns=", "--columns "),
        ("start_index", "--start-index"),
    )
    for member, option in options:
        hint = hint.replace(member, option)
    return {**problem, "hint": hint}


def _cancel_command(client: "ServiceClient") -> str:
    return f"pilothouse task --cancel --url {client.address.url}"
