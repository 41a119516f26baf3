"""Random lives of a supervisor and a device: what the link lets through, and when.

`make soak` tells 10,000 stories, `make test` 60.
"""

import os
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple, TypeAlias

import hypothesis.strategies as st
from hypothesis import HealthCheck, given, settings

from domain.commands import AskRelease
from domain.computers import SUPERVISOR, ComputerName, DeviceState, StopId
from domain.inputs import DeviceStatus, NodeReport, OrderReceived, SupervisorStatus
from domain.lifecycle import LifecycleState
from domain.link.messages import NodeOrder
from domain.timebase import Instant, seconds
from tests.support.linked_pair import BASE, DRIVE, UNCONFIGURED, LinkedRobot, Process

COUNT = 10_000 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 60
STATES = (LifecycleState.INACTIVE, LifecycleState.ACTIVE)
NAMES = st.sampled_from([SUPERVISOR, BASE])


class Way(NamedTuple):
    """From whom, and to whom."""

    sender: ComputerName
    to: ComputerName


class Cut(NamedTuple):
    """A way is cut; what is sent meanwhile may be kept until it is mended."""

    way: Way
    keeps: bool


class Mend(NamedTuple):
    """A way is whole again."""

    way: Way


class Delay(NamedTuple):
    """Messages take longer; a shorter delay lets later ones overtake."""

    way: Way
    delay_s: float


class HoldUp(NamedTuple):
    """Commands and reports take longer than beats."""

    way: Way
    by_s: float


class LoseBeats(NamedTuple):
    """Of what goes a way, beats alone do not arrive."""

    way: Way


class Double(NamedTuple):
    """Each message arrives twice, or no longer."""

    way: Way


class Restart(NamedTuple):
    """A process is killed, and another one starts."""

    name: ComputerName
    down_s: float


class ChangeOfState(NamedTuple):
    """The node of the device changes its state."""

    state: LifecycleState


class Press(NamedTuple):
    """Another emergency stop is engaged at a computer, instead of its last one."""

    name: ComputerName


Step: TypeAlias = Cut | Mend | Delay | HoldUp | LoseBeats | Double | Restart | ChangeOfState | Press
Story: TypeAlias = list[tuple[float, Step]]

WAYS = st.sampled_from([Way(SUPERVISOR, BASE), Way(BASE, SUPERVISOR)])
STEPS: st.SearchStrategy[Step] = st.one_of(
    st.builds(Cut, WAYS, st.booleans()),
    st.builds(Mend, WAYS),
    st.builds(Delay, WAYS, st.sampled_from([0.0, 0.02, 0.2])),
    st.builds(HoldUp, WAYS, st.sampled_from([0.0, 1.0, 2.5, 6.0])),
    st.builds(LoseBeats, WAYS),
    st.builds(Double, WAYS),
    st.builds(Restart, NAMES, st.sampled_from([0.0, 2.0])),
    st.builds(ChangeOfState, st.sampled_from(STATES)),
    st.builds(Press, NAMES),
)
WAITS = st.sampled_from([0.03, 0.4, 1.43, 1.6, 3.0])
STORIES = st.lists(st.tuples(WAITS, STEPS), max_size=15)


class Life:
    """A robot that is told a story; its supervisor commands the node all the time."""

    def __init__(self) -> None:
        self.robot = LinkedRobot.out_of_step()
        self.alive: dict[ComputerName, Process] = {
            SUPERVISOR: self.robot.supervisor,
            BASE: self.robot.base,
        }
        self.truth = UNCONFIGURED
        self.forgotten: set[StopId] = set()
        """Stops of the device of which its next process knew nothing."""
        self._presses = 0

    def live(self, for_s: float) -> None:
        """Let time pass in which a command is given every 70 ms."""
        end = self.robot.now + seconds(for_s)
        while self.robot.now < end:
            self.robot.order(process=self.alive[SUPERVISOR])
            self.robot.run(0.07)

    def meet(self, step: Step) -> None:
        """Let something happen."""
        robot = self.robot
        match step:
            case Cut(way, keeps):
                robot.way(*way).is_cut, robot.way(*way).keeps = True, keeps
            case Mend(way):
                robot.mend_one(*way)
                robot.way(*way).loses_beats = False
            case Delay(way, delay_s):
                robot.way(*way).delay = seconds(delay_s)
            case HoldUp(way, by_s):
                robot.way(*way).order_delay = seconds(by_s)
            case LoseBeats(way):
                robot.way(*way).loses_beats = True
            case Double(way):
                robot.way(*way).doubles = not robot.way(*way).doubles
            case Restart(name, down_s):
                self.restart(name, down_s)
            case ChangeOfState(state):
                self.truth = replace(self.truth, state=state)
                robot.note(NodeReport(DRIVE, state), self.alive[BASE])
            case Press(name):
                self._presses += 1
                robot.engage(self.alive[name], f"{name}-{self._presses}")

    def restart(self, name: ComputerName, down_s: float) -> None:
        """Let a process end, and another one begin, which knows nothing of it."""
        if name == BASE:
            self.forgotten |= self.engaged(name)
        self.robot.kill(self.alive[name])
        self.robot.run(down_s)
        self.alive[name] = self.robot.start(name)
        if name == BASE:
            self.truth = UNCONFIGURED

    def engaged(self, name: ComputerName) -> set[StopId]:
        """Return the stops that are engaged at a computer."""
        stops = self.alive[name].machine.peers.stops
        return {stop.id for stop in stops.told(self.robot.now)}

    def heal(self) -> None:
        """Let the network be whole, for 5 s."""
        for way in ((SUPERVISOR, BASE), (BASE, SUPERVISOR)):
            self.robot.mend_one(*way)
            self.robot.way(*way).delay = seconds(0.001)
            self.robot.way(*way).order_delay = 0
            self.robot.way(*way).loses_beats = False
            self.robot.way(*way).doubles = False
        self.robot.run(5)

    def changes(self, process: Process, *states: DeviceState) -> list[Instant]:
        """Return when the connection came into one of some states."""
        return [
            at
            for at, given_ in process.inputs
            if isinstance(given_, DeviceStatus | SupervisorStatus) and given_.state in states
        ]

    def orders(self) -> dict[int, tuple[Instant, NodeOrder]]:
        """Return all commands that were sent, and when, by the number of their request."""
        return {
            message.command.request: (at, message)
            for at, _, message in self.robot.sent
            if isinstance(message, NodeOrder)
        }


def told(story: Story) -> Life:
    life = Life()
    for wait_s, step in story:
        life.live(wait_s)
        life.meet(step)
    return life


@settings(max_examples=COUNT, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(STORIES)
def test_no_command_of_before_a_loss_is_carried_out_after_the_return(
    story: Story,
) -> None:
    life = told(story)
    life.heal()
    orders = life.orders()

    for device in (process for process in life.robot.processes if process.name == BASE):
        done: list[int] = []
        for at, given_ in device.inputs:
            if not isinstance(given_, OrderReceived):
                continue
            request = given_.command.request
            sent_at, order = orders[request]
            losses = life.changes(device, DeviceState.LOST)
            assert not any(sent_at < lost <= at for lost in losses), (sent_at, at)
            (sender,) = (
                process
                for process in life.robot.processes
                if process.machine.peers.own.incarnation == order.incarnation
            )
            returns = life.changes(sender, DeviceState.CONNECTED)
            lost_there = life.changes(sender, DeviceState.LOST)
            for lost in lost_there:
                assert not any(sent_at < lost < back <= at for back in returns), (sent_at, at)
            assert at - sent_at < seconds(1.8)
            done.append(request)
        assert all(one < later for one, later in pairwise(done)), "once each, in order"


@settings(max_examples=COUNT, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(STORIES)
def test_when_the_network_is_whole_both_know_what_is(
    story: Story,
) -> None:
    life = told(story)
    life.heal()
    supervisor, device = life.alive[SUPERVISOR], life.alive[BASE]

    for process in (supervisor, device):
        assert process.status().state is DeviceState.CONNECTED
    assert _last_known(supervisor) == (life.truth.state, True)
    assert device.stops_of(SUPERVISOR) == life.engaged(SUPERVISOR)
    # From here, a device that forgot its stop looks the same as one that took another one's name.
    left = supervisor.stops_of(BASE) - life.engaged(BASE)
    assert left <= life.forgotten
    life.robot.tell(supervisor, AskRelease(BASE, tuple(map(StopId, left))))
    life.robot.run(1)
    assert supervisor.stops_of(BASE) == life.engaged(BASE)


def test_what_a_device_forgot_ends_only_when_somebody_names_it() -> None:
    life = told([(1.6, Press(BASE)), (0.4, Restart(BASE, 2.0))])
    life.heal()

    assert life.alive[SUPERVISOR].stops_of(BASE) == life.forgotten == {"base-1"}


def _last_known(supervisor: Process) -> tuple[LifecycleState | None, bool]:
    """Return the state of the node, and whether it is reachable, as the supervisor knows."""
    state: LifecycleState | None = None
    is_reachable = False
    for _, report in supervisor.reports():
        state = report.state or state
        is_reachable = is_reachable if report.reachable is None else report.reachable
    return state, is_reachable
