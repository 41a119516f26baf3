"""Distributes published frames to any number of readers; a slow reader skips frames."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

from domain.computers import ComputerName
from domain.devices.device_view import DeviceView
from domain.devices.lead_view import LeadView
from domain.reactions.reaction_view import ReactionView
from domain.snapshot import (
    EmergencyStopView,
    ErrorView,
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

Name = TypeVar("Name", bound=str)
View = TypeVar("View")

PARTS_AT_ONCE = ERRORS_AT_ONCE = 250
"""Changed parts, and changed errors, in one frame. The others wait for the next ones, in the order
in which they changed: encoding the parts of a large robot at once would delay this frame and those
after it."""

ENDED_KEPT = 2_400
"""Frames for which an error that ended is still in complete frames: two minutes at 20 Hz. A reader
that takes no frame for some seconds is disconnected."""

LARGE = 500
"""A robot with more parts is large: whoever missed frames of it is told only what changed since."""


@dataclass(frozen=True, slots=True)
class Frame:
    """The state of the robot as published at one instant."""

    seq: int
    """Increases by one per frame."""
    at: Instant
    system_state: SystemStateView
    parts: Mapping[PartName, PartView]
    """The parts that changed since the previous frame; in a full frame, all parts."""
    signals: Mapping[str, SignalView]
    """As for `parts`."""
    errors: Mapping[str, ErrorView]
    """As for `parts`, by name; a full frame has those that are not normal, and those that ended a
    short time ago."""
    reactions: Mapping[str, ReactionView]
    """As for `parts`, by name."""
    devices: Mapping[ComputerName, DeviceView]
    """As for `parts`; empty in all frames: the robot has one computer."""
    lead: LeadView | None
    """On a device, which it is and whose word counts; None: it is no device."""
    lead_changed: bool
    """As `task_changed`."""
    task: TaskView | None
    """The current task, or else the last one; None: there has been none."""
    task_changed: bool
    """Whether `task` differs from the previous frame; always true in a full frame."""
    vehicle: VehicleView
    vehicle_changed: bool
    """As `task_changed`."""
    holds: Mapping[str, HoldView]
    """All holds, by owner."""
    holds_changed: bool
    """As `task_changed`."""
    emergency_stop: EmergencyStopView
    emergency_stop_changed: bool
    """As `task_changed`."""
    full: bool
    simulated: tuple[str, ...]
    """The simulated pieces of the robot: `nodes`, `vehicle`, `signals`."""


class FrameFeed(Watched):
    """A single slot with the newest frame, so that slow readers do not use up memory.

    The feed also keeps the newest view of every part and signal. A reader that is new, or that
    missed a frame, gets a complete frame, and the others still get only the changes.
    """

    def __init__(self) -> None:
        super().__init__()
        self._newest: Frame | None = None
        self._complete: Frame | None = None
        self._parts = _Members[PartName, PartView]()
        self._errors = _Members[str, ErrorView]()
        """Also those that ended, so that who merges frames learns of each end."""
        self._ended_in: dict[str, int] = {}
        """Number of the frame that told the end of an error, the oldest first."""
        self._reactions: dict[str, ReactionView] = {}
        self._devices: dict[ComputerName, DeviceView] = {}
        self._signals: dict[str, SignalView] = {}
        self._has_all = False

    @property
    def newest(self) -> Frame | None:
        """The newest frame; None before the first."""
        return self._newest

    @property
    def parts(self) -> Mapping[PartName, PartView]:
        """The newest view of every part; read only."""
        return self._parts.views

    @property
    def errors(self) -> Mapping[str, ErrorView]:
        """The newest view of every error that was told; read only."""
        return self._errors.views

    @property
    def signals(self) -> Mapping[str, SignalView]:
        """The newest view of every signal; read only."""
        return self._signals

    @property
    def wants_full(self) -> bool:
        """Tell whether a full frame is needed first: until then readers get nothing."""
        return not self._has_all

    def publish(self, frame: Frame) -> None:
        """Replace the newest frame and wake the readers. Never blocks."""
        self._parts.take(frame.parts, frame.seq)
        self._errors.take(frame.errors, frame.seq)
        self._forget_ended(frame)
        self._reactions.update(frame.reactions)
        self._devices.update(frame.devices)
        self._signals.update(frame.signals)
        self._has_all = self._has_all or frame.full
        self._newest = frame
        self._complete = frame if frame.full else None
        self._wake_watchers()

    def _forget_ended(self, frame: Frame) -> None:
        """Forget errors that ended so long ago that every reader took a frame since."""
        for name, view in frame.errors.items():
            self._ended_in.pop(name, None)
            if not view.is_open:
                self._ended_in[name] = frame.seq
        while self._ended_in:
            name, ended_in = next(iter(self._ended_in.items()))
            if ended_in > frame.seq - ENDED_KEPT:
                return
            del self._ended_in[name]
            self._errors.drop(name)

    def complete(self) -> Frame | None:
        """Return the newest frame with all parts and signals; None before the first full frame.

        It is built once per frame and shared by all readers that need it.
        """
        if self._complete is None and self._newest is not None and self._has_all:
            self._complete = replace(
                _all_changed(self._newest),
                parts=dict(self.parts),
                signals=dict(self._signals),
                errors=dict(self.errors),
                reactions=dict(self._reactions),
                devices=dict(self._devices),
                full=True,
            )
        return self._complete

    def since(self, seen: int | None) -> Frame | None:
        """Return the newest frame for a reader that missed some; None before the first full frame.

        It is complete, but of a large robot only what changed since is told: a complete frame takes
        so long that a reader that missed one frame would miss the next one, too.

        Args:
            seen: Number of the last frame that the reader took; None: none.
        """
        newest = self._newest
        if seen is None or newest is None or len(self.parts) <= LARGE:
            return self.complete()
        return replace(
            _all_changed(newest),
            parts=dict(self.parts_since(seen)),
            signals=dict(self._signals),
            errors=dict(self.errors_since(seen)),
            reactions=dict(self._reactions),
            devices=dict(self._devices),
            full=False,
        )

    def parts_since(self, seen: int) -> Iterator[tuple[PartName, PartView]]:
        """Yield the parts that changed after the frame `seen`, the newest first."""
        return self._parts.since(seen)

    def errors_since(self, seen: int) -> Iterator[tuple[str, ErrorView]]:
        """Yield the errors that changed after the frame `seen`, the newest first."""
        return self._errors.since(seen)


class _Members(Generic[Name, View]):
    """The newest view of each member of a topic; those that changed last come last."""

    def __init__(self) -> None:
        self.views: dict[Name, View] = {}
        self._changed_in: dict[Name, int] = {}
        """Number of the frame in which each changed last."""

    def take(self, views: Mapping[Name, View], seq: int) -> None:
        """Take over the members that a frame tells."""
        for name, view in views.items():
            if self.views.get(name) is not view:
                self.views.pop(name, None)
                self.views[name] = view
                self._changed_in[name] = seq

    def drop(self, name: Name) -> None:
        """Forget a member."""
        del self.views[name], self._changed_in[name]

    def since(self, seen: int) -> Iterator[tuple[Name, View]]:
        """Yield the members that changed after the frame `seen`, the newest first."""
        for name in reversed(self.views):
            if self._changed_in[name] <= seen:
                return
            yield name, self.views[name]


def _all_changed(frame: Frame) -> Frame:
    """Return a frame that tells everything anew but parts, signals and errors."""
    return replace(
        frame,
        lead_changed=True,
        task_changed=True,
        vehicle_changed=True,
        holds_changed=True,
        emergency_stop_changed=True,
    )


class FrameReader:
    """The position of one reader in a feed."""

    def __init__(self, feed: FrameFeed) -> None:
        self._feed = feed
        self._seen: int | None = None

    @property
    def position(self) -> int | None:
        """Return the number of the last frame taken; None before the first."""
        return self._seen

    def begin_anew(self) -> None:
        """Take a complete frame next, even if it is the one that was taken last."""
        self._seen = None

    def take(self) -> tuple[Frame, int] | None:
        """Return the newest frame and how many were skipped; None: there is no new one.

        The first frame is complete, and so is a frame after skipped ones; see `FrameFeed.since`.
        """
        newest = self._feed.newest
        if newest is None or newest.seq == self._seen:
            return None
        skipped = 0 if self._seen is None else newest.seq - self._seen - 1
        in_step = self._seen is not None and skipped == 0
        frame = newest if in_step else self._feed.since(self._seen)
        if frame is None:
            return None
        self._seen = frame.seq
        return frame, skipped
