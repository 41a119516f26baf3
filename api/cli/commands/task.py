"""`pilothouse task`: submit the waypoints of a file as a task, and follow its progress."""

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from http import HTTPStatus
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from api.cli.commands.command import Command, add_url, with_service
from api.cli.terminal_line import TerminalLine
from api.client.outcomes import Json, Outcome, ServiceProblemError

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

_TEXT = """\
Submit the waypoints of a CSV file as a task, which replaces the current one,
and follow it to its end. Each line is x,y,yaw in m, m and rad; --heading sets
another unit of yaw.

While there are holds, such as during an error, the task waits. After Ctrl-C
the task continues; --cancel cancels it.

exit code: 0 succeeded, or done; 1 rejected, canceled or aborted;
           2 unknown: no answer
"""

_STANDARD_INPUT = Path("/dev/stdin")
_POLL_S = 0.2
_BAR = 15
_ENDS = {
    "SUCCEEDED": Outcome.SUCCEEDED,
    "CANCELED": Outcome.FAILED,
    "ABORTED": Outcome.FAILED,
}

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
        choices=("rad", "deg", "compass"),
        help="unit of the third column: rad (default) or deg, counter-clockwise from east;"
        " compass: degrees clockwise from north",
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
    add_url(parser)


def _run(options: argparse.Namespace) -> int:
    if options.cancel:
        return with_service(options.url, lambda client: cancel(client, print))
    asked = TaskOptions(
        file=options.file,
        controller=options.controller,
        speed_mps=options.speed,
        heading=options.heading,
        start_index=options.start_index,
        preview=options.preview,
        wait=options.wait,
    )
    return with_service(options.url, lambda client: run_task(client, asked, print))


COMMAND = Command("task", "submit or cancel a waypoint task", _TEXT, _add_options, _run)

# --- what it does --------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class TaskOptions:
    """Options of a task; None: the default of the service."""

    file: str
    """Path of a CSV; `-` is the standard input."""
    controller: str | None = None
    speed_mps: float | None = None
    heading: str | None = None
    """`rad`, `deg` or `compass`."""
    start_index: int | None = None
    preview: bool = False
    """Start nothing."""
    wait: bool = True
    """Follow the task to its end."""

    @property
    def query(self) -> dict[str, str | int | float]:
        """Return what stands in the query beside a CSV."""
        given = {
            "controller": self.controller,
            "speed_mps": self.speed_mps,
            "heading": self.heading,
            "start_index": self.start_index,
        }
        return {name: value for name, value in given.items() if value is not None}


def run_task(
    client: "ServiceClient",
    asked: TaskOptions,
    say: Say,
    complaints: TextIO | None = None,
    pause: Callable[[float], None] = time.sleep,
) -> Outcome:
    """Preview a task, start it, and follow it to its end.

    Args:
        client: Where to ask.
        asked: What is driven and how.
        say: Takes a line for the user.
        complaints: Where to write why a file cannot be driven, and the line that is redrawn; None:
            the standard error.
        pause: Waits for a number of seconds.

    Raises:
        ServiceProblemError: It was refused, and not for the waypoints.
        NoAnswerError: Nobody answered; whether the task was started is not known.
    """
    err: TextIO = complaints or sys.stderr
    text = _text_of(asked.file, err)
    if text is None:
        return Outcome.FAILED
    try:
        found = client.call("POST", "/tasks/preview", csv=text, query=asked.query)
        for line in preview_lines(asked.file, found):
            say(line)
        if asked.preview:
            return Outcome.SUCCEEDED
        task = client.call("POST", "/tasks", csv=text, query=asked.query)
    except ServiceProblemError as error:
        if not error.problem.get("findings"):
            raise ServiceProblemError(_in_options(error.problem)) from error
        for line in fault_lines(asked.file, text, error.problem):
            print(line, file=err)
        return Outcome.FAILED
    if not asked.wait:
        say(f"task {task['id']} is started: {_state(task)}")
        return Outcome.SUCCEEDED
    try:
        with TerminalLine(err) as progress:
            return _follow(client, task, say, progress, pause)
    except KeyboardInterrupt:
        say(f"task {task['id']} goes on; to cancel it: {_cancel_command(client)}")
        raise


def _text_of(file: str, complaints: TextIO) -> str | None:
    """Return what a file holds, or say why it cannot be read."""
    from service.files.text_file import UnreadableFileError, read_text_file

    try:
        return read_text_file(_STANDARD_INPUT if file == "-" else Path(file))
    except UnreadableFileError as error:
        print(f"pilothouse: {error}", file=complaints)
        return None


def cancel(client: "ServiceClient", say: Say) -> Outcome:
    """Cancel the current task.

    Raises:
        ServiceProblemError: It was refused.
        NoAnswerError: Nobody answered.
    """
    try:
        task = client.call("GET", "/tasks/current")
    except ServiceProblemError as error:
        if error.problem.get("status") != HTTPStatus.NOT_FOUND:
            raise
        say("there is no task to cancel")
        return Outcome.SUCCEEDED
    client.call("DELETE", "/tasks/current")
    ended = client.call("GET", f"/tasks/{task['id']}")
    say(f"task {ended['id']} after {_way(ended)}: {_state(ended)}")
    return Outcome.SUCCEEDED


def preview_lines(file: str, found: Json) -> Iterator[str]:
    """Yield what is known of waypoints before they are driven.

    Args:
        file: Where they are from.
        found: The answer of `POST /tasks/preview`.
    """
    count, length_m = found["waypoint_count"], found["length_m"]
    yield f"{file}: {count} waypoints, {length_m:.1f} m, some {found['duration_s']:.0f} s"
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
    for warning in found["warnings"]:
        place = "" if warning["index"] is None else f" (waypoint {warning['index']})"
        yield f"  warning {warning['code']}: {warning['message']}{place}"


def fault_lines(file: str, text: str, problem: Json) -> Iterator[str]:
    """Yield why waypoints were refused: each fault with its line, and what helps.

    Args:
        file: Where they are from.
        text: What was sent.
        problem: The answer.
    """
    lines = text.split("\n")
    for finding in problem["findings"]:
        number, column = finding["line"] or 1, finding["column"] or 1
        yield f"{file}:{number}:{column}: {finding['code']} {finding['message']}"
        if number <= len(lines) and lines[number - 1].strip():
            yield f"    {lines[number - 1].rstrip()[:100]}"
    yield "refused: nothing is started"
    if problem.get("hint"):
        yield f"  hint: {_in_options(problem)['hint']}"


def _in_options(problem: Json) -> Json:
    """Return a problem whose hint names options instead of members of a request."""
    hint = problem.get("hint") or ""
    for member, option in (("?heading=", "--heading "), ("start_index", "--start-index")):
        hint = hint.replace(member, option)
    return {**problem, "hint": hint}


def _follow(
    client: "ServiceClient",
    task: Json,
    say: Say,
    line: TerminalLine,
    pause: Callable[[float], None],
) -> Outcome:
    """Tell how far a task is, until it ends; where there is no terminal, each change of state."""
    told = ""
    while task["status"] not in _ENDS:
        if line.is_shown:
            line.show(_progress(task, client.call("GET", "/vehicle")["speed_mps"]))
        elif told != (told := _state(task)):
            say(f"task {task['id']} at {_way(task)}: {told}")
        pause(_POLL_S)
        try:
            task = client.call("GET", f"/tasks/{task['id']}")
        except ServiceProblemError as error:
            line.erase()
            say(f"task {task['id']}: what became of it is not known: {error}")
            return Outcome.UNKNOWN
    line.erase()
    say(f"task {task['id']} after {_way(task)}: {_state(task)}")
    return _ENDS[task["status"]]


def _progress(task: Json, speed_mps: float | None) -> str:
    """Return how far a task is, and how it drives, or why it does not; for 80 columns."""
    share = task["progress"]
    bar = ("#" * round(share * _BAR)).ljust(_BAR, ".")
    begin = f"[{bar}] {share:4.0%} {_way(task)}"
    if task["reason"]:
        return f"{begin}  {_state(task)}"
    speed = "? m/s" if speed_mps is None else f"{speed_mps:.1f} m/s"
    error_m = task["cross_track_error_m"]
    error = "" if error_m is None else f"  {error_m:+.2f} m off"
    return f"{begin}  {speed}{error}  {_state(task)}"


def _way(task: Json) -> str:
    return f"{task['distance_m']:.1f} of {task['length_m']:.1f} m"


def _state(task: Json) -> str:
    words, reason = str(task["status"]).lower(), task["reason"]
    return f"{words}: {reason}" if reason and reason != words else words


def _cancel_command(client: "ServiceClient") -> str:
    return f"pilothouse task --cancel --url {client.url}"
