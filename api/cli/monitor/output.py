"""Writes pictures one below the other, as text or JSON, without drawing on a terminal."""

import json
import sys
from collections.abc import Hashable
from typing import Literal, TextIO

from rich.console import Console

from api.cli.monitor import words
from api.cli.monitor.picture import picture
from api.cli.monitor.sentence import alarm_of
from api.cli.monitor.store import Json, Robot
from api.cli.monitor.view import Level, View

Form = Literal["text", "json"]


def write_picture(view: View, form: Form, console: Console) -> None:
    """Write the known state.

    Args:
        view: What is drawn.
        form: `text` for people, `json` for programs: one object in one line.
        console: Where to write.
    """
    if form == "json":
        console.file.write(f"{json.dumps(view.robot.as_json(), allow_nan=False)}\n")
    else:
        for line in picture(view, console):
            console.print(line, no_wrap=True, overflow="crop")
    console.file.flush()


class ChangeLog:
    """Writes a picture whenever something changed, and reports lost connections."""

    def __init__(self, form: Form, console: Console, complaints: TextIO | None = None) -> None:
        """Write nothing yet.

        Args:
            form: `text` for people, `json` for programs.
            console: Where to write.
            complaints: Where to report lost connections; None: the standard error.
        """
        self._form: Form = form
        self._console = console
        self._complaints = complaints or sys.stderr
        self._told: object = None
        self._why = ""

    def look(self, view: View) -> None:
        """Write a picture or a report if something changed."""
        contact = view.contact
        if contact.why != self._why:
            self._why = contact.why
            if contact.why:
                print(f"pilothouse: {contact.why}; reconnecting", file=self._complaints, flush=True)
        if not view.robot.is_whole or (self._form == "json" and contact.level is not Level.LIVE):
            return
        now = (contact.level, what_stands(view.robot))
        if now == self._told:
            return
        if self._told is not None and self._form == "text":
            self._console.print()
        self._told = now
        write_picture(view, self._form, self._console)


def what_stands(robot: Robot) -> Hashable:
    """Return a key that changes with states, reasons, tasks and holds, but not with values."""
    state, task, stop = robot.system_state, robot.task, robot.emergency_stop
    return (
        robot.epoch,
        None if state is None else (state["state"], *state["errors"], alarm_of(state)),
        None if state is None else state.get("storage_fault"),
        tuple(_part(part) for part in (robot.parts or {}).values()),
        None if task is None else (task["id"], task["status"]),
        None if stop is None else (stop["engaged"], stop["standstill_at"]),
        tuple((hold["owner"], hold["reason"]) for hold in (robot.holds or {}).values()),
    )


def _part(part: Json) -> Hashable:
    pairs = (part["target"], part["effective_target"], part["actual"])
    labels = tuple(None if pair is None else (pair["state"], pair["mode"]) for pair in pairs)
    setter = words.setter(part["effective_target"])
    return (part["name"], labels, setter, part["converged"], part.get("reachable"))
