"""One step of the core as it is recorded: the input, and all that followed."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from zlib import crc32

from domain.commands import Command
from domain.events.event import RecordedEvent
from domain.inputs import Input
from domain.kept import Keeping
from domain.outbox import Outputs
from domain.timebase import Instant

_MANY = 1_000
"""Names that take long to sort."""


@dataclass(frozen=True, slots=True)
class RecordedStep:
    """What a core that is in the same state does again, given the same input at the same time."""

    at: Instant
    given: Input
    is_late: bool
    """Whether it was late by our own fault: `Onboard.take_in`, not `handle`."""
    commands: tuple[Command, ...] = ()
    events: tuple[RecordedEvent, ...] = ()
    kept: tuple[Keeping, ...] = ()
    views: int | None = None
    """Checksum of what else the outputs say: which views changed, and what a request began; None:
    it was not recorded."""


def recorded_step(at: Instant, given: Input, is_late: bool, outputs: Outputs) -> RecordedStep:
    """Return a step as it is recorded."""
    return RecordedStep(
        at, given, is_late, outputs.commands, outputs.events, outputs.kept, _checksum(outputs)
    )


def _checksum(outputs: Outputs) -> int:
    """Return 0 for outputs without changed views, and else what depends on nothing but them."""
    flags = (outputs.system_state, outputs.task_changed, outputs.vehicle_changed)
    begun = (outputs.change or "", outputs.task or "")
    views = (outputs.parts, outputs.signals, outputs.errors, outputs.devices)
    if not (any(flags) or any(begun) or any(views)):
        return 0
    # The order in which a set is walked differs from process to process.
    lines = [repr(flags), *begun, _joined(outputs.parts), _joined(outputs.signals)]
    if outputs.errors:
        lines.append(_joined(key.name for key in outputs.errors))
    if outputs.devices:
        lines.append(_joined(outputs.devices))
    return crc32("\n".join(lines).encode())


def _joined(names: Iterable[str]) -> str:
    if isinstance(names, frozenset) and len(names) > _MANY:
        return _joined_once(names)
    return "\t".join(sorted(names))


@lru_cache(maxsize=4)
def _joined_once(names: frozenset[str]) -> str:
    """Return many names in their order; requests of a large robot change the same ones again."""
    return "\t".join(sorted(names))
