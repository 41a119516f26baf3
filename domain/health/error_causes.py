"""Which errors explain which: what the model file declares, and what follows from the parts."""

from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from itertools import chain, islice, pairwise
from types import MappingProxyType
from typing import TypeAlias

from domain.circles import circles
from domain.conditions.condition import Condition
from domain.conditions.tree import Comparison, Operator, TopicKind, comparisons
from domain.health.built_in_errors import (
    ALL_OF_NODES,
    DEVIATES,
    LOST,
    OF_CHECKPOINTS,
    OF_DEVICES,
    OF_EVERY_PART,
    OF_NODES,
    OF_PROCESSES,
    UNREACHABLE,
    severity_of,
)
from domain.parts.declared_errors import DeclaredError
from domain.parts.errors_check import named_errors
from domain.parts.system_model import SmhModel
from domain.snapshot import ErrorKey, Severity
from domain.state_and_mode import PartName

MAX_SHOWN = 20
"""Largest number of causes of one error that are looked for; more would not be read."""

Place: TypeAlias = tuple[int, int, int]
"""Where an error stands in the order of decisions: its level, its part, its place there."""

_POSITIONS = {error: position for position, error in enumerate(ALL_OF_NODES)}

_OF_NODES_WITH: Mapping[tuple[bool, bool], Mapping[str, Severity]] = MappingProxyType(
    {
        (False, False): OF_NODES,
        (False, True): {**OF_NODES, **OF_CHECKPOINTS},
        (True, False): {**OF_PROCESSES, **OF_NODES},
        (True, True): ALL_OF_NODES,
    }
)
"""Built-in errors of a node, by whether its process is run here, and its checkpoints supervised."""

_Link: TypeAlias = tuple[ErrorKey, ErrorKey]
"""An error, and another one that explains it."""


class ErrorCauses:
    """The graph of errors of one robot; it has no circle.

    Beside what is declared: what rests on whether nodes are reachable is explained by UNREACHABLE
    of these nodes, and that a system deviates by the parts that do; that a node is UNREACHABLE, by
    its device if that is LOST, or by its process. Such a link is left out where it would close a
    circle, since what is declared prevails.
    """

    def __init__(
        self,
        model: SmhModel,
        with_checkpoints: Container[PartName] = (),
        devices: Mapping[PartName, Sequence[PartName]] = MappingProxyType({}),
        with_processes: Container[PartName] = (),
    ) -> None:
        """Gather what explains what.

        Args:
            model: Systems and nodes, with the errors that the file declares.
            with_checkpoints: Nodes whose checkpoints are supervised.
            devices: By device, the nodes that it owns; no device has the name of a part.
            with_processes: Nodes whose process is run here.
        """
        self._model = model
        self.devices = devices
        """By device, its nodes; read only."""
        self._device_of = {node: name for name, nodes in devices.items() for node in nodes}
        self._with_checkpoints = with_checkpoints
        self._with_processes = with_processes
        self.declared: Mapping[ErrorKey, DeclaredError] = {
            ErrorKey(part, name): own
            for part, of_part in model.errors.items()
            for name, own in of_part.items()
        }
        """All errors of the model file, in its order."""
        self._rank = {part: number for number, part in enumerate(model.parts)}
        self._implied = {key: self._implied_of(key.part, own) for key, own in self.declared.items()}
        self._left_out = set[_Link]()
        if any(own.caused_by and self.is_built_in(key) for key, own in self.declared.items()):
            self._leave_out_circles()
        self._causes = {key: tuple(self._all_causes(key)) for key in self.declared}
        self._effects: dict[ErrorKey, list[ErrorKey]] = {}
        for key, causes in self._causes.items():
            for cause in causes:
                self._effects.setdefault(cause, []).append(key)
        self._levels: dict[ErrorKey, int] = {}
        """How far errors are from what depends on nothing; `_level` knows those of most."""
        self._find_levels()
        self._places = {
            ErrorKey(part, name): position
            for part in model.errors
            for position, name in enumerate(self.names_of(part))
        }

    # --- what can be seen ------------------------------------------------------------------------

    def names_of(self, part: PartName) -> Iterable[str]:
        """Return the errors that a part can have: the built-in ones, then those of the file.

        A device can have those of devices.
        """
        if part in self.devices:
            return OF_DEVICES
        built_in = OF_EVERY_PART
        if part in self._model.nodes:
            special = part in self._with_processes, part in self._with_checkpoints
            built_in = _OF_NODES_WITH[special]
        own = self._model.errors.get(part)
        return (*built_in, *(name for name in own if name not in built_in)) if own else built_in

    def is_of_device(self, key: ErrorKey) -> bool:
        """Tell whether an error is that of a device."""
        return key.part in self.devices

    def severity_of(self, key: ErrorKey) -> Severity:
        """Return the severity of an error that no signal raises."""
        if self.is_of_device(key):
            return OF_DEVICES.get(key.error, Severity.WARNING)
        own = self.declared.get(key)
        return severity_of(key) if own is None or own.severity is None else own.severity

    def place(self, key: ErrorKey) -> Place:
        """Return where an error is decided: after all that it depends on; ties as in the file."""
        if key.part is None:
            return (0, -1, 0)
        return (self._level(key), self._rank.get(key.part, -1), self._position(key))

    def declared_effects(self, key: ErrorKey) -> Sequence[ErrorKey]:
        """Return the errors of which the file says something and that an error explains."""
        return self._effects.get(key, ())

    def effects(self, key: ErrorKey, is_on: Callable[[ErrorKey], bool]) -> Iterator[ErrorKey]:
        """Yield the errors that an error explains: those that are on, or may follow from it.

        Args:
            key: The error.
            is_on: Tells whether an error is on.
        """
        yield from self._effects.get(key, ())
        part, error = key
        if part is None:
            return
        if error == LOST:
            unreachable = (ErrorKey(node, UNREACHABLE) for node in self.devices.get(part, ()))
            yield from (each for each in unreachable if is_on(each) and each not in self._causes)
        if error in OF_PROCESSES:
            unreachable_node = ErrorKey(part, UNREACHABLE)
            if is_on(unreachable_node) and unreachable_node not in self._causes:
                yield unreachable_node
        if error not in (UNREACHABLE, DEVIATES):
            return
        deviating = [ErrorKey(part, DEVIATES)] if error == UNREACHABLE else []
        systems = (ErrorKey(system, DEVIATES) for system in self._model.ancestors.get(part, ()))
        deviating += [each for each in systems if is_on(each) and self._is_direct(each.part, part)]
        for effect in deviating:
            if is_on(effect) and effect not in self._causes and (effect, key) not in self._left_out:
                yield effect

    def present(
        self,
        key: ErrorKey,
        on: Mapping[str, Mapping[PartName, None]],
        is_on: Callable[[ErrorKey], bool],
    ) -> tuple[ErrorKey, ...]:
        """Return the causes of an error that are on, in their order; at most `MAX_SHOWN`.

        Args:
            key: The error.
            on: By name of an error, the parts that have it.
            is_on: Tells whether an error is on.
        """
        found: Iterator[ErrorKey]
        if key in self._causes:
            found = (cause for cause in self._causes[key] if is_on(cause))
        elif key.error == UNREACHABLE:
            found = filter(is_on, self._of_unreachable(key.part))
        elif key.part is None or key.error != DEVIATES:
            return ()
        elif key.part in self._model.systems:
            found = self._deviating_below(key.part, on)
        else:
            found = filter(is_on, (ErrorKey(key.part, UNREACHABLE),))
        return tuple(islice(found, MAX_SHOWN))

    def _position(self, key: ErrorKey) -> int:
        position = self._places.get(key)
        return _POSITIONS.get(key.error, len(_POSITIONS)) if position is None else position

    def is_built_in(self, key: ErrorKey) -> bool:
        """Tell whether a part has an error without a word in the model file."""
        return key.error in (ALL_OF_NODES if key.part in self._model.nodes else OF_EVERY_PART)

    def is_reported(self, key: ErrorKey) -> bool:
        """Tell whether an error is declared, and others find it and report it."""
        own = self.declared.get(key)
        if own is None or self.is_built_in(key):
            return False
        return own.when is None and not own.caused_by

    # --- what the parts imply --------------------------------------------------------------------

    def _implied_of(self, part: PartName | None, own: DeclaredError) -> tuple[ErrorKey, ...]:
        """Return the errors of nodes on whose reachability a condition rests."""
        if own.when is None or part is None:
            return ()
        nodes = chain.from_iterable(
            self._model.nodes_below(name)
            for name in _unreachable_parts(own.when)
            if name in self._model
        )
        return tuple(ErrorKey(node, UNREACHABLE) for node in dict.fromkeys(nodes))

    def _all_causes(self, key: ErrorKey) -> Iterator[ErrorKey]:
        own = self.declared[key]
        yield from own.caused_by
        implied = self._implied[key]
        if key.error == DEVIATES and key.part is not None:
            implied = tuple(self._of_deviation(key.part))
        elif key.error == UNREACHABLE:
            implied = self._of_unreachable(key.part)
        for cause in implied:
            if cause not in own.caused_by and (key, cause) not in self._left_out:
                yield cause

    def _of_unreachable(self, node: PartName | None) -> tuple[ErrorKey, ...]:
        """Return what can explain that a node is unreachable, apart from what is declared."""
        if node is None:
            return ()
        device = self._device_of.get(node)
        of_device = () if device is None else (ErrorKey(device, LOST),)
        if node not in self._with_processes:
            return of_device
        return (*of_device, *(ErrorKey(node, error) for error in OF_PROCESSES))

    def _of_deviation(self, part: PartName) -> Iterator[ErrorKey]:
        """Yield what can explain that a part deviates, apart from what is declared."""
        if part in self._model.nodes:
            yield ErrorKey(part, UNREACHABLE)
        for below in self._parts_of(part):
            yield ErrorKey(below, DEVIATES)
            if below in self._model.nodes:
                yield ErrorKey(below, UNREACHABLE)

    def _parts_of(self, part: PartName) -> tuple[PartName, ...]:
        system = self._model.systems.get(part)
        return () if system is None else system.named_parts

    def _is_direct(self, system: PartName | None, part: PartName) -> bool:
        return system is not None and any(
            part in wanted for wanted in self._model.systems[system].modes.values()
        )

    def _deviating_below(
        self, system: PartName, on: Mapping[str, Mapping[PartName, None]]
    ) -> Iterator[ErrorKey]:
        """Yield which parts of a system deviate or are unreachable; looks at the smaller side."""
        for error in (DEVIATES, UNREACHABLE):
            with_it = on.get(error, {})
            parts = (
                self._parts_of(system)
                if len(with_it) > MAX_SHOWN
                else sorted(
                    (part for part in with_it if self._is_direct(system, part)),
                    key=self._rank.__getitem__,
                )
            )
            for part in parts:
                key = ErrorKey(part, error)
                if part in with_it and (ErrorKey(system, DEVIATES), key) not in self._left_out:
                    yield key

    # --- order -----------------------------------------------------------------------------------

    def _needs(self, key: ErrorKey) -> tuple[ErrorKey, ...]:
        """Return what has to be decided before an error."""
        own = self.declared.get(key)
        if own is None:
            if key.part is None or key.error != DEVIATES:
                return ()
            causes = self._of_deviation(key.part)
            return tuple(c for c in causes if (key, c) not in self._left_out)
        return (*self._all_causes(key), *named_errors(own.when), *named_errors(own.unless))

    def _leave_out_circles(self) -> None:
        """Leave out an implied link of each circle, until there is none."""
        starts = [*self.declared, *(ErrorKey(part, DEVIATES) for part in self._model.systems)]
        while True:
            needs: dict[ErrorKey, tuple[ErrorKey, ...]] = {}
            waiting = list(starts)
            while waiting:
                key = waiting.pop()
                if key not in needs:
                    needs[key] = self._needs(key)
                    waiting.extend(needs[key])
            found = list(circles(needs))
            if not found:
                return
            for circle in found:
                links = pairwise(circle)
                self._left_out.add(next(link for link in links if not self._is_declared(link)))

    def _is_declared(self, link: _Link) -> bool:
        own = self.declared.get(link[0])
        if own is None:
            return False
        return link[1] in (*own.caused_by, *named_errors(own.when), *named_errors(own.unless))

    def _level(self, key: ErrorKey) -> int:
        level = self._levels.get(key)
        if level is not None:
            return level
        return 1 if key.error == DEVIATES and key.part is not None else 0

    def _find_levels(self) -> None:
        waiting = [*self.declared, *(ErrorKey(part, DEVIATES) for part in self._model.systems)]
        while waiting:
            key = waiting[-1]
            needs = () if key in self._levels else self._needs(key)
            open_ones = [n for n in needs if self._has_level(n) and n not in self._levels]
            if open_ones:
                waiting.extend(open_ones)
                continue
            if key not in self._levels:
                self._levels[key] = 1 + max(map(self._level, needs), default=-1)
            waiting.pop()

    def _has_level(self, key: ErrorKey) -> bool:
        """Tell whether the level of an error has to be found."""
        return key in self.declared or (key.error == DEVIATES and key.part in self._model.systems)


NO_CAUSES = ErrorCauses(SmhModel({}, {}))
"""Of a robot without parts."""


def _unreachable_parts(condition: Condition) -> Iterator[PartName]:
    """Yield the parts that a condition asks not to be reachable, or not to have converged."""
    for leaf in comparisons(condition.root):
        kind, name, _ = leaf.subject.topic
        is_asked = leaf.subject.attribute in ("reachable", "converged") and _asks_for_false(leaf)
        if kind is TopicKind.PART and is_asked:
            yield PartName(name)


def _asks_for_false(leaf: Comparison) -> bool:
    match leaf.operator:
        case Operator.EQUAL | Operator.IN:
            return False in leaf.values
        case Operator.NOT_EQUAL | Operator.NOT_IN:
            return False not in leaf.values
    return False
