"""Publishes frames: 20 per second, and one immediately when the system state changes."""

import logging
from collections.abc import Callable, Mapping
from itertools import islice
from operator import attrgetter
from typing import Generic, TypeVar

from domain.computers import ComputerName
from domain.devices.device_view import DeviceView
from domain.outbox import Outputs
from domain.reactions.reaction_view import ReactionView
from domain.snapshot import ErrorKey, ErrorView, PartView, SignalView
from domain.state_and_mode import PartName
from domain.supervision import Supervision
from domain.timebase import Instant, seconds, to_seconds
from service.clock import Clock
from service.frame_feed import ERRORS_AT_ONCE, PARTS_AT_ONCE, Frame, FrameFeed

log = logging.getLogger(__name__)

Key = TypeVar("Key", PartName, ErrorKey)

PERIOD = seconds(0.05)

_NO_DEVICES: Mapping[ComputerName, DeviceView] = {}

REPEATS_EVERY = seconds(0.5)
"""How often a signal is told whose value stays, and that is only received again: at 10 Hz, such
signals would be three quarters of what a client of an idle robot gets."""


_STAYS = attrgetter(*(name for name in SignalView._fields if name not in ("received_at", "stamp")))
"""All that is told of a signal but when it was received."""


class FramePublisher:
    """Makes frames from the views of the core; each holds the changes since the previous one."""

    def __init__(self, core: Supervision, clock: Clock, simulated: tuple[str, ...] = ()) -> None:
        """Prepare; nothing is published yet.

        Args:
            core: Provides the views.
            clock: Of the service.
            simulated: The simulated pieces of the robot, as in `Frame`.
        """
        self.frames = FrameFeed()
        self.seq = 0
        """Number of the newest frame."""
        self.late_ticks = 0
        """Number of skipped ticks."""
        self.last_tick_at: Instant | None = None
        self.published_at: Instant | None = None
        """When the newest frame was published."""
        self.owing_since: Callable[[], Instant | None] = lambda: None
        """Tells since when clients of a stream are not written what was published."""
        self.on_tick: list[Callable[[float], None]] = []
        """Called with the time since the previous tick, s; must return at once."""
        self._core = core
        self._clock = clock
        self._simulated = simulated
        self._changed_parts = _Changed[PartName]()
        self._changed_errors = _Changed[ErrorKey]()
        self._changed_reactions: set[str] = set()
        self._changed_devices: set[ComputerName] = set()
        self._changed_signals: set[str] = set()
        self._signals_told_at: dict[str, Instant] = {}
        self._task_changed = False
        self._vehicle_changed = False

    async def run(self) -> None:
        """Tick at a fixed rate until cancelled; ticks that are missed are skipped and counted."""
        start = self._clock.now()
        count = 0
        while True:
            self._tick()
            count += 1
            late = self._clock.now() - (start + count * PERIOD)
            if late >= PERIOD:
                skipped = late // PERIOD + 1
                count += skipped
                self.late_ticks += skipped
                log.warning("skipped %d ticks: %.0f ms late", skipped, late / 1e6)
            await self._clock.sleep_until(start + count * PERIOD)

    def tick_due(self) -> Instant | None:
        """Return when the next tick has to begin; None: there was none yet."""
        return None if self.last_tick_at is None else self.last_tick_at + PERIOD

    def note(self, outputs: Outputs) -> None:
        """Remember what changed; the next frame shows it."""
        self._changed_parts.note(outputs.parts)
        self._changed_errors.note(outputs.errors)
        self._changed_reactions |= outputs.reactions
        self._changed_devices |= outputs.devices
        self._changed_signals |= outputs.signals
        self._task_changed |= outputs.task_changed
        self._vehicle_changed |= outputs.vehicle_changed

    def publish_change(self) -> None:
        """Publish now instead of at the next tick, unless nothing was published yet."""
        if self.seq:
            self.publish()

    def publish(self) -> None:
        """Publish one frame: everything at first, then the changes since the previous frame."""
        full = self.frames.wants_full
        self.seq += 1
        core = self._core
        holds, emergency_stop = core.driving.holds, core.emergency_stop()
        lead, last = core.lead(), self.frames.newest
        frame = Frame(
            seq=self.seq,
            at=self._clock.now(),
            system_state=core.system_state(),
            parts=self._take_parts(full=full),
            signals=self._take_signals(full=full),
            errors=self._take_errors(full=full),
            reactions=self._take_reactions(full=full),
            devices=self._take_devices(full=full),
            lead=lead,
            lead_changed=full or last is None or lead != last.lead,
            task=core.driving.latest_task if last is None or self._task_changed else last.task,
            task_changed=full or self._task_changed,
            vehicle=core.driving.vehicle,
            vehicle_changed=full or self._vehicle_changed,
            # The core returns the same object as long as nothing in it changes.
            holds=holds,
            holds_changed=full or last is None or holds is not last.holds,
            emergency_stop=emergency_stop,
            emergency_stop_changed=(
                full or last is None or emergency_stop is not last.emergency_stop
            ),
            full=full,
            simulated=self._simulated,
        )
        self._task_changed = self._vehicle_changed = False
        self.frames.publish(frame)
        self.published_at = frame.at

    def _take_parts(self, *, full: bool) -> Mapping[PartName, PartView]:
        """Return all parts for a full frame, or else those that changed first."""
        if full:
            self._changed_parts.clear()
            return self._core.parts()
        return {part: self._core.part(part) for part in self._changed_parts.take(PARTS_AT_ONCE)}

    def _take_errors(self, *, full: bool) -> Mapping[str, ErrorView]:
        """Return the errors that are not normal for a full frame, or else some that changed."""
        if full:
            self._changed_errors.clear()
            return self._core.open_errors()
        taken = self._changed_errors.take(ERRORS_AT_ONCE)
        return {key.name: self._core.error(key) for key in taken}

    def _take_reactions(self, *, full: bool) -> Mapping[str, ReactionView]:
        """Return all reactions for a full frame, or else those that changed."""
        changed, self._changed_reactions = self._changed_reactions, set()
        if full:
            return self._core.reactions()
        return {key: self._core.reaction(key) for key in sorted(changed)}

    def _take_devices(self, *, full: bool) -> Mapping[ComputerName, DeviceView]:
        """Return all devices for a full frame, or else those that changed."""
        changed, self._changed_devices = self._changed_devices, set()
        if not full and not changed:
            return _NO_DEVICES
        views = self._core.devices()
        return {name: view for name, view in views.items() if full or name in changed}

    def _take_signals(self, *, full: bool) -> Mapping[str, SignalView]:
        """Return the signals that changed; one that was only received again waits its turn."""
        now = self._clock.now()
        if full:
            taken = dict(self._core.signals())
        else:
            since, changed = now - REPEATS_EVERY, sorted(self._changed_signals)
            told, told_at = self.frames.signals, self._signals_told_at
            taken = {
                name: view
                for name, view in self._core.signals_named(changed).items()
                if not _only_repeats(view, told.get(name)) or told_at.get(name, since) <= since
            }
        self._changed_signals -= taken.keys()
        self._signals_told_at.update(dict.fromkeys(taken, now))
        return taken

    def _tick(self) -> None:
        now = self._clock.now()
        if self.last_tick_at is not None:
            for observe in self.on_tick:
                observe(to_seconds(now - self.last_tick_at))
        self.last_tick_at = now
        self.publish()


class _Changed(Generic[Key]):
    """What changed and is not in a frame yet, in the order in which it changed."""

    def __init__(self) -> None:
        self._keys: dict[Key, None] = {}
        self._noted: list[frozenset[Key]] = []
        """What changed since, by input; put in order by the next frame: a request may change ten
        thousand parts, and its own turn is long enough."""

    def note(self, keys: frozenset[Key]) -> None:
        """Note what an input changed."""
        if keys:
            self._noted.append(keys)

    def take(self, most: int) -> list[Key]:
        """Remove what changed first, and return it."""
        for keys in self._noted:
            self._keys.update(dict.fromkeys(sorted(keys, key=str)))
        self._noted.clear()
        taken = list(islice(self._keys, most))
        for key in taken:
            del self._keys[key]
        return taken

    def clear(self) -> None:
        """Forget what changed: a full frame tells it."""
        self._keys.clear()
        self._noted.clear()


def _only_repeats(view: SignalView, told: SignalView | None) -> bool:
    """Tell whether a signal is as it was told, and was only received again."""
    # Most have another value, and so nothing else is compared.
    return told is not None and view.value == told.value and _STAYS(view) == _STAYS(told)
