"""Frames, events and views for tests of what is streamed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from domain.actor import Actor
from domain.computers import ComputerName, DeviceState
from domain.devices.device_view import DeviceView
from domain.devices.lead_view import LeadView
from domain.devices.settings import OfflineSettings
from domain.events.event import Event, RecordedEvent
from domain.lifecycle import LifecycleState
from domain.reactions.reaction_view import ReactionView
from domain.snapshot import (
    Actual,
    EmergencyStopView,
    ErrorKey,
    ErrorState,
    ErrorView,
    HoldView,
    PartView,
    Severity,
    SignalView,
    SystemState,
    SystemStateView,
    TaskStatus,
    TaskView,
    VehicleView,
)
from domain.state_and_mode import ModeName, PartName, StateAndMode
from domain.timebase import seconds
from domain.vehicle import DriveCommand
from service.frame_feed import Frame

NOWHERE = VehicleView(None, None, DriveCommand(0.0, 0.0), None)
NO_HOLDS: Mapping[str, HoldView] = MappingProxyType({})
RELEASED = EmergencyStopView(engaged=False, by=None, reason=None, since=None, standstill_at=None)
IDLE = SystemStateView(SystemState.IDLE, 0, (), (), TaskStatus.NO_TASK)


def part_view(name: str, mode: str = "__DEFAULT__") -> PartView:
    """Show a node that is active as asked."""
    wanted = StateAndMode(LifecycleState.ACTIVE, ModeName(mode))
    return PartView(
        name=PartName(name),
        kind="node",
        parts=(),
        target=wanted,
        effective_target=None,
        actual=Actual(wanted.state, wanted.mode),
        converged=True,
        deviation_since=None,
        deviation_reason=None,
        reachable=True,
        change=None,
    )


def device_view(name: str, state: DeviceState = DeviceState.CONNECTED) -> DeviceView:
    """Show a device that owns the node `drive_base`."""
    return DeviceView(
        device=ComputerName(name),
        state=state,
        since=seconds(1),
        reason="",
        parts=(PartName("drive_base"),),
        offline=OfflineSettings(),
        incarnation=None,
        session=None,
        version=None,
        autonomous=False,
        refused="",
        stops=(),
    )


def signal_view(name: str, value: float = 1.0) -> SignalView:
    """Show a signal that is well."""
    return SignalView(
        signal=name,
        value=value,
        unit="",
        source="api",
        received_at=seconds(1),
        stamp=None,
        stale=False,
        error=None,
        pending_error=None,
        pending_since=None,
        pending_needs=None,
        skewed=False,
        needs_acknowledgement=False,
        settings=MappingProxyType({}),
    )


def error_view(part: str | None, error: str, state: ErrorState = ErrorState.ACTIVE) -> ErrorView:
    """Show an error that was raised once."""
    return ErrorView(
        key=ErrorKey(None if part is None else PartName(part), error),
        severity=Severity.WARNING,
        state=state,
        first_out=False,
        message="it is so",
        value=None,
        threshold=None,
        since=seconds(1),
        count=1,
    )


def frame(
    seq: int,
    parts: Sequence[PartView] = (),
    signals: Sequence[SignalView] = (),
    errors: Sequence[ErrorView] = (),
    reactions: Sequence[ReactionView] = (),
    *,
    full: bool = False,
    system_state: SystemStateView = IDLE,
    task: TaskView | None = None,
    task_changed: bool = False,
    vehicle: VehicleView = NOWHERE,
    vehicle_changed: bool = False,
    holds: Mapping[str, HoldView] = NO_HOLDS,
    holds_changed: bool = False,
    emergency_stop: EmergencyStopView = RELEASED,
    emergency_stop_changed: bool = False,
    devices: Sequence[DeviceView] = (),
    lead: LeadView | None = None,
) -> Frame:
    """Make frame number `seq`, of the tick at `seq` * 50 ms."""
    return Frame(
        seq=seq,
        at=seconds(seq * 0.05),
        system_state=system_state,
        parts={view.name: view for view in parts},
        signals={view.signal: view for view in signals},
        errors={view.key.name: view for view in errors},
        reactions={view.name: view for view in reactions},
        devices={view.device: view for view in devices},
        lead=lead,
        lead_changed=full or lead is not None,
        task=task,
        task_changed=full or task_changed,
        vehicle=vehicle,
        vehicle_changed=full or vehicle_changed,
        holds=holds,
        holds_changed=full or holds_changed,
        emergency_stop=emergency_stop,
        emergency_stop_changed=full or emergency_stop_changed,
        full=full,
        simulated=("nodes",),
    )


@dataclass(frozen=True, slots=True)
class Happened(Event):
    """An event of a kind that only tests have."""

    kind = "test.happened"

    number: int

    @property
    def words(self) -> str:
        """Return its number."""
        return f"number {self.number}"


@dataclass(frozen=True, slots=True)
class RareHappened(Happened):
    """One more kind that only tests have."""

    kind = "test.rare"


def event(number: int, happened: type[Happened] = Happened) -> RecordedEvent:
    """Make event number `number`, caused by the one before."""
    return RecordedEvent(
        number, seconds(number), number - 1 or None, Actor("test"), happened(number)
    )
