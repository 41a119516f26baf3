"""The pieces of the picture: each a list of lines for a width and for some number of lines."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

from rich.console import Console
from rich.text import Text

from api.cli.error_lines import SEVERITIES, is_on, is_silenced
from api.cli.monitor import words
from api.cli.monitor.device_words import amiss, heard_last, is_away, own_words, state_words
from api.cli.monitor.lines import counted, wrapped
from api.cli.monitor.rows import MARK_STYLES, UNREACHABLE, WRONG, SignalRow, choose
from api.cli.monitor.sentence import (
    Sentence,
    absence_sentence,
    contact_sentence,
    restart_sentence,
    state_sentence,
    stop_sentence,
    storage_sentence,
)
from api.cli.monitor.table import Column, printable, table
from api.cli.monitor.view import Level, View, seconds_of

Json: TypeAlias = Mapping[str, Any]

_LEVEL_STYLES = {
    "calm": "bold",
    "held": "bold yellow",
    "aborted": "bold yellow",
    "attention": "bold yellow",
    "error": "bold red",
}
_DRIVING = "bold green"
_TITLES = "underline"
_NAMED = 20
"""Most errors that are named; no line has room for more."""
_LEAST_LINES = 2
"""Of a table: the titles, and how many rows there would be."""

_SIGNAL_COLUMNS = (
    Column("  signal", least=10, usual=20),
    Column("value", least=6, usual=14),
    Column("age", least=4, usual=11),
    Column("", least=6),
)


def head(view: View) -> list[Text]:
    """Return title and time of the values; model, address and simulated pieces."""
    robot, at = view.robot, view.robot.at
    title = " System Modes Monitor"
    if at is not None:
        title += f" - {words.date_and_time(seconds_of(at))}"
        if view.contact.level is not Level.LIVE:
            title += " (old)"
    unreal = ", ".join(robot.system_state["simulated"]) if robot.system_state else ""
    about = f" Model: {robot.model or words.UNKNOWN}  {view.url}"
    line = Text(printable(about))
    if unreal:
        line.append(printable(f"  simulated: {unreal}"))
    return [Text(title, style="bold"), line]


def sentences(view: View, console: Console) -> list[Text]:
    """Return the state of the robot with its reasons, and problems of connection and storage."""
    told = (
        contact_sentence(view),
        absence_sentence(view),
        stop_sentence(view),
        state_sentence(view),
        storage_sentence(view),
        restart_sentence(view),
    )
    return [line for said in told if said for line in _sentence_lines(said, console)]


def _sentence_lines(said: Sentence, console: Console) -> list[Text]:
    lines = wrapped(f"{said.word}  {said.text}".rstrip(), console, indent=2)
    is_driving = said.word == "RUNNING" and said.level == "calm"
    style = _DRIVING if is_driving else _LEVEL_STYLES[said.level]
    lines[0].stylize(style, 0, len(said.word))
    for text in said.more:
        lines.extend(wrapped(f"  {text}", console, indent=4))
    return lines


def signals(view: View, every: Sequence[SignalRow], width: int, room: int | None) -> list[Text]:
    """Return the signals with values, ages and errors.

    Args:
        view: What is drawn.
        every: A row for each signal.
        width: In cells.
        room: Most lines; None: as many as needed.
    """
    if room is not None and room < _LEAST_LINES:
        return []
    chosen = choose(every, _rows_in(room))
    rows = [(_signal_cells(view, row), MARK_STYLES[row.mark]) for row in chosen.rows]
    return [*table(_SIGNAL_COLUMNS, rows, width, _TITLES), *counted(chosen, "signals")]


def _signal_cells(view: View, row: SignalRow) -> tuple[str, ...]:
    signal, pending = row.signal, row.signal["pending"]
    pending_s = None if pending is None else view.age_s(pending["since_at"])
    stop = view.robot.emergency_stop
    value = words.value_words(signal, is_stop_engaged=stop is not None and stop["engaged"])
    verdict = words.verdict_words(signal, pending_s, is_live=view.contact.level is Level.LIVE)
    return (f"{row.mark} {row.name}", value, _age(view, row), verdict)


def _age(view: View, row: SignalRow) -> str:
    received_at = row.signal["received_at"]
    if received_at is None:
        return "never"
    age_s = view.age_s(received_at)
    return "now" if age_s < 1 else words.duration(age_s)


def task(view: View, console: Console) -> list[Text]:
    """Return the task and what holds it."""
    robot = view.robot
    now = robot.current_task
    if now is None:
        lines = [Text("no task")]
        if robot.task is not None:
            lines += wrapped(f"  {words.end_words(robot.task)}", console, indent=4)
    else:
        way = f"{words.metres(now['distance_m'])} of {words.metres(now['length_m'])}"
        far = f"{words.percent(now['progress'])}, {way}, {words.waypoint_words(now)}"
        lines = wrapped(f"task {now['id']}  {now['status']}  {far}", console, indent=2)
        lines += wrapped(f"  {words.drive_words(now, robot.vehicle)}", console, indent=4)
        # Holds are listed below, with more detail.
        if now["reason"] and not robot.holds:
            lines += wrapped(f"  {now['reason']}", console, indent=4)
    for hold in (robot.holds or {}).values():
        why = f": {hold['reason']}" if hold["reason"] else ""
        by = f", by {hold['by']}" if hold["by"] not in ("", hold["owner"]) else ""
        since = words.duration(view.known_for_s(hold["since_at"]))
        lines += wrapped(f"  held by {hold['owner']}{why}, for {since}{by}", console, indent=4)
    return lines


def notes(view: View, room: int) -> list[Text]:
    """Return the newest notable events, the newest last."""
    told = view.robot.notes[-room:] if room > 0 else ()
    return [Text(printable(f"{_when(note.at)}  {note.words}"), style="dim") for note in told]


def _when(at: str) -> str:
    return words.time_of_day(seconds_of(at)) if at else " " * 8


def _rows_in(room: int | None) -> int | None:
    """Return how many lines there are below the titles."""
    return None if room is None else room - 1


def errors(view: View) -> list[Text]:
    """Return which errors of parts are on, the worst first; nothing if there is none to tell.

    The robot's own are in the sentence at the top. What follows from an error that is told, and
    what is silenced, is only counted.
    """
    of_parts = [each for each in view.robot.errors.items() if each[1]["part"] is not None]
    on = [(name, error) for name, error in of_parts if is_on(error)]
    silenced = sum(is_silenced(error) for _, error in on)
    loud = [(name, error) for name, error in on if not is_silenced(error)]
    roots = [(name, error) for name, error in reversed(loud) if error["root_cause"]]
    returned = sum(error["state"] == "returned" and not is_silenced(error) for _, error in of_parts)
    more = (
        _some(len(loud) - len(roots), "follow from these"),
        _some(returned, "returned unseen"),
        _some(silenced, "not announced"),
    )
    told = ", ".join(filter(None, (_worst_first(roots), *more)))
    style = MARK_STYLES[WRONG] if loud else ""
    return [Text(printable(told), style=style)] if told else []


def reactions(view: View) -> list[Text]:
    """Return which reactions do something or are kept from it; nothing if there is none."""
    by_state: dict[str, list[str]] = {}
    for name, reaction in view.robot.reactions.items():
        by_state.setdefault(reaction["state"], []).append(name)
    told = [
        f"{len(names)} {state}: {', '.join(names[:_NAMED])}"
        for state in ("exhausted", "acting", "overruled", "passive")
        if (names := by_state.get(state))
    ]
    style = MARK_STYLES[WRONG] if by_state.keys() & {"exhausted", "acting"} else ""
    return [Text(printable(f"reactions: {'; '.join(told)}"), style=style)] if told else []


def devices(view: View) -> list[Text]:
    """Return which device this is and whose word counts, and which devices are not as they should.

    Nothing where the robot has one computer, and where all others are connected.
    """
    own, found = view.robot.this_device, amiss(view.robot.devices)
    lines = [] if own is None else [Text(printable(own_words(own)))]
    if not found:
        return lines
    told = ", ".join(_device_words(view, device) for device in found[:_NAMED])
    style = MARK_STYLES[UNREACHABLE if any(map(is_away, found)) else WRONG]
    return [*lines, Text(printable(f"devices: {told}"), style=style)]


def _device_words(view: View, device: Json) -> str:
    heard = heard_last(device)
    for_time = "" if heard is None else f" for {words.duration(view.known_for_s(heard))}"
    return f"{device['device']} {state_words(device)}{for_time}"


def _worst_first(roots: Sequence[tuple[str, Json]]) -> str:
    if not roots:
        return ""
    count = Counter(error["severity"] for _, error in roots)
    severities = ", ".join(f"{count[each]} {each}" for each in SEVERITIES if count[each])
    ranked = sorted(roots, key=lambda root: SEVERITIES.index(root[1]["severity"]))
    names = ", ".join(name for name, _ in ranked[:_NAMED])
    return f"errors of parts: {severities}: {names}"


def _some(count: int, what: str) -> str:
    return f"{count} {what}" if count else ""
