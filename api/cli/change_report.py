"""How a change is told while it goes on: step by step, or of many nodes as a count."""

import json
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Protocol

from api.cli.terminal_line import TerminalLine
from api.client.outcomes import Json

FEW_NODES = 20
"""Of so many nodes each step is told."""
_MOST_FAULTS = 10
"""Failed steps that are told one by one."""
_LINE_EVERY_S = 2.0
"""Between two counts, where there is no terminal."""

Say = Callable[[str], None]


class Report(Protocol):
    """Tells how a change goes on, and how it ended."""

    def show(self, change: Json) -> None:
        """Tell what is new in a change."""
        ...

    def give_up(self, change: Json, words: str) -> None:
        """Tell that the change has not ended in time."""
        ...

    def end(self, part: str, change: Json, actual: str) -> None:
        """Tell how the change ended.

        Args:
            part: System or node.
            change: As it ended.
            actual: Actual state and mode of the part; empty: not asked for.
        """
        ...


class JsonReport:
    """Prints the change as it ended, or as it is when the time is over."""

    def __init__(self, say: Say) -> None:
        self._say = say

    def show(self, change: Json) -> None:
        """Tell nothing yet."""

    def give_up(self, change: Json, words: str) -> None:
        """Print the change as it is."""
        self._say(json.dumps(change))

    def end(self, part: str, change: Json, actual: str) -> None:
        """Print the change."""
        self._say(json.dumps(change))


class TextReport:
    """Tells each step, or of many nodes how many have arrived."""

    def __init__(self, say: Say, line: TerminalLine | None = None) -> None:
        """Tell nothing yet.

        Args:
            say: Prints a line.
            line: Progress line of the terminal; None: there is none.
        """
        self._say = say
        self._line = line
        self._told: dict[tuple[str, int], str] = {}
        self._is_waiting = False
        self._counted = ""
        self._next_at = 0.0
        self._faults = 0

    def show(self, change: Json) -> None:
        """Tell what is new in a change."""
        if change["status"] == "waiting" and not self._is_waiting:
            self._is_waiting = True
            self._say(f"waits: {change['reason']}")
        if is_large(change):
            self._show_count(change["steps"])
            return
        for line in self._news(change["steps"]):
            self._say(line)

    def give_up(self, change: Json, words: str) -> None:
        """Tell that the change has not ended in time."""
        self._erase()
        self._say(words)

    def end(self, part: str, change: Json, actual: str) -> None:
        """Tell how the change ended."""
        self._erase()
        if is_large(change):
            if self._faults > _MOST_FAULTS:
                self._say(f"{self._faults - _MOST_FAULTS:,} more steps failed")
            self._say(_count(change["steps"]))
        reason = f": {change['reason']}" if change["reason"] else ""
        now = f"; it is {actual} now" if actual else ""
        self._say(f"{part}: {words_of(change['status'])}{reason}{now}")

    def _news(self, steps: Sequence[Json]) -> Iterator[str]:
        """Yield a line for each step that changed; the steps of a node keep their order."""
        for step in self._changed(steps):
            ending = "..." if step["status"] == "running" else _ending(step)
            yield f"{words_of(step['action'])} {step['node']}{ending}"

    def _changed(self, steps: Sequence[Json]) -> Iterator[Json]:
        seen: dict[str, int] = {}
        for step in steps:
            number = seen[step["node"]] = seen.get(step["node"], 0) + 1
            key, status = (step["node"], number), step["status"]
            if status == "pending" or self._told.get(key) == status:
                continue
            self._told[key] = status
            yield step

    def _show_count(self, steps: Sequence[Json]) -> None:
        """Tell how many nodes have arrived, and each step that failed, up to some."""
        for step in self._changed(steps):
            if step["status"] in ("pending", "running", "succeeded"):
                continue
            self._faults += 1
            if self._faults <= _MOST_FAULTS:
                self._erase()
                self._say(f"{words_of(step['action'])} {step['node']}{_ending(step)}")
        counted, now = _count(steps), time.monotonic()
        if self._line is not None and self._line.is_shown:
            self._line.show(counted)
        elif counted != self._counted and now >= self._next_at:
            self._counted, self._next_at = counted, now + _LINE_EVERY_S
            self._say(counted)

    def _erase(self) -> None:
        if self._line is not None:
            self._line.erase()


def is_large(change: Json) -> bool:
    """Tell whether a change is of so many nodes that only their number is told."""
    return len({step["node"] for step in change["steps"]}) > FEW_NODES


def words_of(label: str) -> str:
    """Return a label of the interface in words: `set parameters`."""
    return label.replace("_", " ")


def _count(steps: Sequence[Json]) -> str:
    """Return "312 of 1,000 nodes": those of which all steps succeeded."""
    nodes = {step["node"] for step in steps}
    left = {step["node"] for step in steps if step["status"] != "succeeded"}
    return f"{len(nodes) - len(left):,} of {len(nodes):,} nodes"


def _ending(step: Json) -> str:
    return f": {words_of(step['status'])}" + (f": {step['error']}" if step["error"] else "")
