"""The devices of the robot as a concern of the supervisor: who is there, and what follows if not.

The state machines of `domain.link` decide how a connection is. They report a device that is lost
before its nodes, which are then unreachable, and one that is connected after its nodes.
"""

from collections.abc import Container, Mapping
from dataclasses import replace

from domain.computers import ComputerName, DeviceState
from domain.concern import Concern, Takers
from domain.devices.device_view import DeviceView
from domain.devices.owned_facts import OwnedFacts
from domain.devices.settings import DeviceSettings
from domain.errors import UnknownPartError
from domain.events.devices import (
    DeviceConflict,
    DeviceConnected,
    DeviceLate,
    DeviceLost,
    DeviceReported,
)
from domain.events.event import Event
from domain.findings import Blocker
from domain.health.built_in_errors import DEVICE_CONFLICT, LATE, LOST
from domain.health.emergency_stop import EmergencyStop
from domain.health.error_list import ErrorList, Found
from domain.inputs import DeviceStatus, Restored
from domain.outbox import Outbox
from domain.parts.node_doubts import DEVICE_LOST
from domain.parts.parts import Parts
from domain.snapshot import ErrorKey, ErrorState
from domain.state_and_mode import PartName
from domain.timebase import Duration, Instant


class Devices(Concern):
    """Raises the errors of devices, and says why nothing is heard of their nodes.

    A device is LOST until it is first connected. That is neither told as raised nor as cleared: it
    is how each robot of several computers begins. Until each was heard, or could have been, nothing
    is concluded from what is not known: rules, fallbacks and reactions wait.
    """

    def __init__(
        self,
        devices: Mapping[ComputerName, DeviceSettings],
        heard_within: Duration,
        parts: Parts,
        errors: ErrorList,
        stop: EmergencyStop,
        outbox: Outbox,
        start: Instant,
    ) -> None:
        """Begin without a device that was heard.

        Args:
            devices: All devices of the robot, by name.
            heard_within: How long it is waited for them after a start.
            parts: Are told why nothing is heard of nodes.
            errors: Receives the errors of devices.
            stop: Tells which emergency stops are engaged on devices.
            outbox: Receives events.
            start: The current time.
        """
        self._settings = devices
        self._heard_within = heard_within
        self._parts = parts
        self._errors = errors
        self._stop = stop
        self._stop_seen = stop.view()
        self._outbox = outbox
        self._views = {name: _never_seen(each, start) for name, each in devices.items()}
        self.owned_facts = OwnedFacts(devices.values(), parts.model, errors)
        """What only devices may say; read only."""
        self._unheard = set(devices)
        """Devices that were not connected since the start."""
        self._waits_until = start + heard_within
        self._awaited = set(devices)
        """Devices whose nodes are waited for."""
        parts.await_devices(wait=bool(devices))
        for name in devices:
            self._cut_off(name)
            self._errors.note(_key(name, LOST), Found(ErrorState.ACTIVE, self._why(name)), start)

    # --- what happens ----------------------------------------------------------------------------

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {DeviceStatus: self.take_status, Restored: self.restore}

    def restore(self, restored: Restored, now: Instant) -> None:
        """Wait for all devices again after a restart."""
        if restored.is_restart and self._settings:
            self._waits_until = now + self._heard_within
            self._awaited = set(self._settings)
            self._parts.await_devices(wait=True)

    def take_status(self, status: DeviceStatus, now: Instant) -> None:
        """Take how the connection to a device is; only a change is told.

        Raises:
            UnknownPartError: The robot has no such device.
        """
        name = status.device
        before = self._views.get(name)
        if before is None:
            raise UnknownPartError("device", name, tuple(self._views))
        after = replace(
            before,
            state=status.state,
            since=before.since if status.state is before.state else now,
            reason=status.reason,
            # What was known of a device that is lost stays known.
            incarnation=status.incarnation or before.incarnation,
            session=status.session,
            version=status.version or before.version,
            autonomous=status.autonomous,
            refused=status.refused,
        )
        if after == before:
            return
        self._views[name] = after
        self._outbox.devices.add(name)
        self._outbox.begin(now, _told(before, after))
        self._outbox.record_input()
        self._cut_off(name)
        self._judge(name, now)

    def wake_at(self) -> Instant | None:
        """Return when it is no longer waited for devices; None: it is not."""
        return self._waits_until if self._awaited else None

    def pass_time(self, now: Instant) -> None:
        """Wait no longer for devices that could have been heard by now."""
        if self._awaited and now >= self._waits_until:
            self._awaited.clear()
            self._parts.await_devices(wait=False)

    def settle(self, now: Instant) -> bool:
        """Show stops of devices; wait no longer once something is known of each of their nodes."""
        if self._stop.view() is not self._stop_seen:
            self._follow_stops()
        if not self._awaited:
            return False
        self._awaited -= {name for name in self._awaited if self._is_known(name)}
        if self._awaited:
            return False
        self._parts.await_devices(wait=False)
        return True

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def unheard(self) -> Container[str]:
        """Return the devices that were not connected since the start; read only."""
        return self._unheard

    def views(self) -> Mapping[ComputerName, DeviceView]:
        """Return all devices, in the order of the robot file."""
        return dict(self._views)

    # --- inside ----------------------------------------------------------------------------------

    def _follow_stops(self) -> None:
        self._stop_seen = self._stop.view()
        for name, view in self._views.items():
            stops = tuple(each.id for each in self._stop_seen.stops if each.computer == name)
            if stops != view.stops:
                self._views[name] = replace(view, stops=stops)
                self._outbox.devices.add(name)

    def _is_known(self, name: ComputerName) -> bool:
        facts = self._parts.facts
        is_there = self._views[name].is_connected
        return is_there and all(
            facts[node].reachable is not None for node in self._settings[name].nodes
        )

    def _why(self, name: ComputerName) -> str:
        """Return why a device is not connected, as a sentence."""
        view = self._views[name]
        never = f"device {name} was never heard of"
        is_never = view.state is DeviceState.NEVER_SEEN
        return view.reason or (never if is_never else f"device {name} is not connected")

    def _cut_off(self, name: ComputerName) -> None:
        """Say why nothing is heard of the nodes of a device, or that it is connected."""
        view = self._views[name]
        why = None
        if not view.is_connected:
            values = "" if name in self._unheard else ", its last values are old"
            why = Blocker(
                DEVICE_LOST, f"{self._why(name)}{values}", (), since=view.since, refuses=False
            )
        self._parts.note_cut_off(view.parts, why)

    def _judge(self, name: ComputerName, now: Instant) -> None:
        """Raise and clear the errors of a device."""
        view = self._views[name]
        late = view.reason or f"device {name} is late"
        self._set(name, LATE, late if view.state is DeviceState.LATE else "", now)
        is_conflict = view.state is DeviceState.CONFLICT
        self._set(name, DEVICE_CONFLICT, self._why(name) if is_conflict else view.refused, now)
        lost = _key(name, LOST)
        if view.is_connected and name in self._unheard:
            self._unheard.discard(name)
            self._errors.forget(lost)
            return
        causes = (_key(name, DEVICE_CONFLICT),) if is_conflict else ()
        self._errors.explain(lost, causes)
        if name in self._unheard:
            self._errors.note(lost, Found(ErrorState.ACTIVE, self._why(name)), now)
        else:
            self._set(name, LOST, "" if view.is_connected else self._why(name), now)

    def _set(self, name: ComputerName, error: str, words: str, now: Instant) -> None:
        key = _key(name, error)
        if words:
            self._errors.raise_(key, Found(ErrorState.ACTIVE, words), now)
        else:
            self._errors.clear(key)


def _key(name: ComputerName, error: str) -> ErrorKey:
    """Return an error of a device, whose name is none of a part."""
    return ErrorKey(PartName(name), error)


def _never_seen(settings: DeviceSettings, start: Instant) -> DeviceView:
    return DeviceView(
        device=settings.name,
        state=DeviceState.NEVER_SEEN,
        since=start,
        reason="",
        parts=settings.nodes,
        offline=settings.offline,
        incarnation=None,
        session=None,
        version=None,
        autonomous=False,
        refused="",
        stops=(),
    )


def _told(before: DeviceView, after: DeviceView) -> Event:
    """Return the event that describes a change of a device."""
    name, state = after.device, after.state
    known = before.incarnation
    is_other_run = known is not None and after.incarnation != known
    has_moved = state is not before.state
    is_other_reason = after.reason != before.reason
    if state is DeviceState.CONNECTED and (has_moved or is_other_run):
        return DeviceConnected(name, before.state, is_other_run)
    if state is DeviceState.LATE and has_moved:
        return DeviceLate(name, after.reason)
    if state is DeviceState.CONFLICT and (has_moved or is_other_reason):
        return DeviceConflict(name, after.reason)
    if not after.is_connected and (has_moved or is_other_reason):
        return DeviceLost(name, after.reason)
    if after.refused and after.refused != before.refused:
        return DeviceConflict(name, after.refused)
    return DeviceReported(name, after.version, after.autonomous)
