"""Hand what the tick publishes to any number of readers; a slow one skips and delays nobody."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from domain.snapshot import (
    EmergencyStopView,
    HoldView,
    PartView,
    SignalView,
    SystemStateView,
    TaskView,
    VehicleView,
)
from domain.state_and_mode import PartName
from domain.timebase import Instant
from service.watching import Watched


@dataclass(frozen=True, slots=True)
class Frame:
    """What is published at one moment."""

    seq: int
    """Rises by one per frame."""
    at: Instant
    system_state: SystemStateView
    parts: Mapping[PartName, PartView]
    """Those that changed since the frame before; in a full frame, all."""
    signals: Mapping[str, SignalView]
    """As `parts`."""
    task: TaskView | None
    """The current task, or the one that ended last; None: there never was one."""
    task_changed: bool
    """Whether `task` is another one, or differs from the frame before; true in a full frame."""
    vehicle: VehicleView
    vehicle_changed: bool
    """As `task_changed`."""
    holds: Mapping[str, HoldView]
    """All of them, by owner."""
    holds_changed: bool
    """As `task_changed`."""
    emergency_stop: EmergencyStopView
    emergency_stop_changed: bool
    """As `task_changed`."""
    full: bool
    simulated: tuple[str, ...]
    """What of the robot is not real."""


class FrameFeed(Watched):
    """One slot with the newest frame: memory does not grow with readers that are slow.

    The feed also keeps the newest view of every part and signal, so that a reader that begins, or
    that missed something, gets everything without a larger frame for the others.
    """

    def __init__(self) -> None:
        super().__init__()
        self._newest: Frame | None = None
        self._complete: Frame | None = None
        self._parts: dict[PartName, PartView] = {}
        self._signals: dict[str, SignalView] = {}
        self._has_all = False

    @property
    def newest(self) -> Frame | None:
        """The frame that was published last; None before the first."""
        return self._newest

    @property
    def wants_full(self) -> bool:
        """Tell whether no full frame was ever published; readers get nothing until then."""
        return not self._has_all

    def publish(self, frame: Frame) -> None:
        """Replace the newest frame and wake the readers. Never blocks."""
        self._parts.update(frame.parts)
        self._signals.update(frame.signals)
        self._has_all = self._has_all or frame.full
        self._newest = frame
        self._complete = frame if frame.full else None
        self._wake_watchers()

    def complete(self) -> Frame | None:
        """Return the newest frame with all parts and signals; None before the first full frame.

        It is made once per frame, so that all who need it share the same object.
        """
        if self._complete is None and self._newest is not None and self._has_all:
            self._complete = replace(
                self._newest,
                parts=dict(self._parts),
                signals=dict(self._signals),
                task_changed=True,
                vehicle_changed=True,
                holds_changed=True,
                emergency_stop_changed=True,
                full=True,
            )
        return self._complete


class FrameReader:
    """The place of one reader in a feed."""

    def __init__(self, feed: FrameFeed) -> None:
        self._feed = feed
        self._seen: int | None = None

    @property
    def position(self) -> int | None:
        """Return the number of the frame that was taken last; None before the first."""
        return self._seen

    def begin_anew(self) -> None:
        """Take a complete frame next, also if it is the one that was taken last."""
        self._seen = None

    def take(self) -> tuple[Frame, int] | None:
        """Return the newest frame and how many were missed before it; None when it is known.

        The first frame, and one after a miss, is complete.
        """
        newest = self._feed.newest
        if newest is None or newest.seq == self._seen:
            return None
        skipped = 0 if self._seen is None else newest.seq - self._seen - 1
        in_step = self._seen is not None and skipped == 0
        frame = newest if in_step else self._feed.complete()
        if frame is None:
            return None
        self._seen = frame.seq
        return frame, skipped
