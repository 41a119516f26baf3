"""Fault trees of a robot: which errors lead, alone or together, to each error that stops the task.

An error that follows from others is a gate. One that is detected, reported or built in is a basic
event, also where its causes are declared: they explain it, and do not raise it. `unless` and times
are left out, so that no combination is missed; some may be harmless at the moment.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Final

from domain.analysis.cut_sets import MAX_CUT_SETS, Event, Gate, minimal_cut_sets
from domain.health.built_in_errors import ALL_OF_NODES, OF_EVERY_PART
from domain.parts.system_model import SmhModel
from domain.snapshot import ErrorKey, Severity

TOO_MANY_CUT_SETS: Final = "TOO_MANY_CUT_SETS"
"""Code of an error of which not all cut sets were found."""


@dataclass(frozen=True, slots=True)
class Causes:
    """What an error follows from."""

    errors: tuple[ErrorKey, ...]
    need_all: bool
    """It follows from all of them together; False: from any of them."""


@dataclass(frozen=True, slots=True)
class ErrorGraph:
    """The errors that stop the task, and all that lead to them; plain values for a process."""

    tops: Mapping[ErrorKey, Severity]
    """The critical and fatal errors: the robot's own, then those of the parts in file order."""
    followed: Mapping[ErrorKey, Causes]
    """What the errors follow from that do; every other error is a basic event."""
    basic: tuple[ErrorKey, ...]
    """The basic events, in the order of `tops`."""


@dataclass(frozen=True, slots=True)
class FaultTree:
    """What leads to a critical or fatal error."""

    key: ErrorKey
    severity: Severity
    is_basic: bool
    """Nothing leads to it: it is detected, reported or built in."""
    cut_sets: tuple[tuple[ErrorKey, ...], ...]
    """The smallest sets of basic events that raise it, single points of failure first."""
    complete_to: int | None
    """None: these are all of them. Else there are too many, and these are all of at most so many
    errors."""

    @property
    def single_points(self) -> tuple[ErrorKey, ...]:
        """Return the errors each of which raises it alone."""
        return tuple(errors[0] for errors in self.cut_sets if len(errors) == 1)

    @property
    def problem(self) -> str | None:
        """Return why cut sets are missing; None: none are."""
        if self.complete_to is None:
            return None
        known = f"only those of at most {self.complete_to} errors" if self.complete_to else "none"
        return (
            f"more than {MAX_CUT_SETS:,} cut sets lead to {self.key.name}, or they take too long"
            f" to find; {known} are listed"
        )


def error_graph(model: SmhModel, found: Mapping[ErrorKey, Severity]) -> ErrorGraph:
    """Return the critical and fatal errors of a robot, and the errors that they follow from.

    Args:
        model: Systems and nodes, with the errors that the file declares.
        found: The errors that signals raise, in the order in which they are shown.
    """
    declared = {
        ErrorKey(part, name): error
        for part in model.parts
        for name, error in model.errors.get(part, {}).items()
    }
    built_in = {key: _built_in(model, key) for key in declared}
    severities = {
        key: error.severity or built_in[key] or Severity.WARNING for key, error in declared.items()
    }
    severities |= found
    followed = {
        key: Causes(error.caused_by, error.need_all)
        for key, error in declared.items()
        if error.when is None and error.caused_by and not built_in[key] and key not in found
    }
    place = _places(model, found, declared)
    tops = {
        key: severities[key] for key in sorted(severities, key=place) if severities[key].stops_task
    }
    reached = _reached(tops, followed)
    return ErrorGraph(
        tops,
        {key: followed[key] for key in followed if key in reached},
        tuple(sorted(reached.difference(followed), key=place)),
    )


def fault_trees(graph: ErrorGraph) -> tuple[FaultTree, ...]:
    """Return what leads to each critical or fatal error, in the order of the graph."""
    keys = (*graph.basic, *graph.followed)
    numbers = {key: Event(number) for number, key in enumerate(keys)}
    gates = {
        numbers[key]: Gate(tuple(numbers[cause] for cause in causes.errors), causes.need_all)
        for key, causes in graph.followed.items()
    }
    found = minimal_cut_sets(gates, [numbers[key] for key in graph.tops])
    return tuple(
        FaultTree(
            key,
            severity,
            key not in graph.followed,
            tuple(tuple(keys[event] for event in events) for events in found[numbers[key]].sets),
            found[numbers[key]].order,
        )
        for key, severity in graph.tops.items()
    )


def _built_in(model: SmhModel, key: ErrorKey) -> Severity | None:
    """Return the severity of a built-in error; None: the part has none such."""
    return (ALL_OF_NODES if key.part in model.nodes else OF_EVERY_PART).get(key.error)


def _reached(tops: Iterable[ErrorKey], followed: Mapping[ErrorKey, Causes]) -> set[ErrorKey]:
    """Return errors and all that they follow from."""
    reached: set[ErrorKey] = set()
    waiting = list(tops)
    while waiting:
        key = waiting.pop()
        if key not in reached:
            reached.add(key)
            waiting.extend(followed[key].errors if key in followed else ())
    return reached


def _places(
    model: SmhModel, found: Iterable[ErrorKey], declared: Iterable[ErrorKey]
) -> Callable[[ErrorKey], tuple[int, int, str]]:
    """Return the place of an error: the robot's own come first, then part by part."""
    ranks = {part: number for number, part in enumerate(model.parts)}
    numbers = {error: number for number, error in enumerate(ALL_OF_NODES)}
    places = {key: number for number, key in enumerate((*found, *declared), len(numbers))}
    last = len(numbers) + len(places)

    def place(key: ErrorKey) -> tuple[int, int, str]:
        rank = -1 if key.part is None else ranks[key.part]
        # Without the robot file, a cause may be the error of a signal that is not known.
        number = places.get(key, numbers.get(key.error, last))
        return rank, number, key.error

    return place
