"""Who is connected: nobody that was not heard, or did not hear, for as long as the lease lasts."""

from dataclasses import dataclass, field

from domain.computers import SUPERVISOR, ComputerName, DeviceState, Incarnation
from domain.inputs import DeviceStatus, Input, SupervisorStatus
from domain.lifecycle import LifecycleState
from domain.link.messages import Beat, Message
from domain.link.outputs import Sending
from domain.timebase import Duration, Instant, seconds
from tests.support.network_world.processes import Process
from tests.support.network_world.robots import Arrangement

LATE, LOST = seconds(0.5), seconds(1.5)
BEAT, BEAT_AMONG_DEVICES = seconds(0.1), seconds(0.5)
SLACK = seconds(0.02)
"""Between a limit and the next time at which somebody looks."""


@dataclass
class _Peer:
    """What one process could know of another computer."""

    state: DeviceState = DeviceState.NEVER_SEEN
    heard_at: Instant | None = None
    """Any beat under its name."""
    echoed: Instant | None = None
    """When the newest own beat was sent that was echoed."""
    sent: dict[int, Instant] = field(default_factory=dict)
    """Own beats: their numbers, and when they were sent."""
    last: int = 0
    """Number of the last of them."""


class LeaseOracle:
    """Invariant 5: what cannot be heard is not shown as connected, and not as well."""

    def __init__(self, arrangement: Arrangement) -> None:
        self._arrangement = arrangement
        self._peers: dict[Incarnation, dict[ComputerName, _Peer]] = {}
        self._awake_since: dict[Incarnation, Instant] = {}

    def began(self, process: Process) -> None:
        names = (SUPERVISOR, *self._arrangement.devices)
        self._peers[process.incarnation] = {n: _Peer() for n in names if n != process.name}

    def sent(self, process: Process, sending: Sending) -> None:
        if not isinstance(sending.message, Beat):
            return
        peer = self._peers[process.incarnation][sending.to]
        assert sending.message.seq > peer.last, f"{sending} after number {peer.last}"
        if peer.sent:
            at = peer.sent[peer.last]
            allowed = self._period(process.name, sending.to) + SLACK
            slept = self._awake_since.get(process.incarnation, 0) > at
            assert slept or process.now - at <= allowed, f"{process.name} missed a beat: {sending}"
        peer.last = sending.message.seq
        peer.sent[peer.last] = process.now

    @staticmethod
    def _period(one: ComputerName, other: ComputerName) -> Duration:
        return BEAT if SUPERVISOR in (one, other) else BEAT_AMONG_DEVICES

    def awoke(self, process: Process, now: Instant) -> None:
        """Note that a process slept until now, and so sent nothing."""
        self._awake_since[process.incarnation] = now

    def told(self, process: Process, inputs: tuple[Input, ...]) -> None:
        peers = self._peers[process.incarnation]
        for given in inputs:
            match given:
                case SupervisorStatus(state=state):
                    peers[SUPERVISOR].state = state
                case DeviceStatus(device=device, state=state):
                    peers[device].state = state

    def read(self, process: Process, message: Message) -> None:
        if not isinstance(message, Beat):
            return
        peer = self._peers[process.incarnation][message.sender]
        peer.heard_at = process.now
        if message.heard == process.incarnation:
            at = peer.sent.get(message.heard_seq)
            if at is not None:
                peer.echoed = max(at, peer.echoed or 0)

    def look(self, process: Process, now: Instant) -> None:
        """Judge what a process says of others now; it is awake."""
        for name, peer in self._peers[process.incarnation].items():
            if SUPERVISOR in (process.name, name):
                self._judge(process, name, peer, now)

    def _judge(self, process: Process, name: ComputerName, peer: _Peer, now: Instant) -> None:
        is_well = peer.state is DeviceState.CONNECTED
        is_followed = is_well or peer.state is DeviceState.LATE
        where = f"{name} is {peer.state} at {process.name}"
        silent = now - (process.started_at if peer.heard_at is None else peer.heard_at)
        unheard = now - (process.started_at if peer.echoed is None else peer.echoed)
        assert not is_well or silent <= LATE + SLACK, f"{where}, and was silent for {silent} ns"
        assert not is_followed or silent <= LOST + SLACK, f"{where}, and was silent for {silent} ns"
        assert not is_followed or unheard <= LOST + SLACK, f"{where}: no echo for {unheard} ns"
        if process.is_supervisor and not is_followed:
            for node in self._arrangement.devices[name].nodes:
                view = process.core.part(node)
                assert not view.reachable, f"{where}, and its node {node} is reachable"
                assert not view.converged or view.effective_target is None, f"{where}: {node} OK"
                assert view.actual.state is not LifecycleState.ACTIVE or not view.reachable
