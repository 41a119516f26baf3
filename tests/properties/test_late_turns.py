"""Whatever happens during a stall of the loop: what arrived in time counts, and nothing else does.

One robot lives through a stall; its twin does not stall. What both are told is the same, only that
the first is told late. Afterwards both agree on what is wrong.
"""

import asyncio
from dataclasses import dataclass

import hypothesis.strategies as st
from hypothesis import given, settings

from domain.inputs import NodeReport, Reading, Readings, VehicleReport
from domain.lifecycle import LifecycleState
from domain.state_and_mode import PartName
from domain.timebase import Instant, seconds
from domain.vehicle import Pose, VehicleState
from service.catch_up import MOST_WINDOWS, WINDOW, CatchUp
from service.refused_readings import RefusedReadings
from service.storage.journal import Step
from service.submitter import Submitter
from tests.support.good import GOOD
from tests.support.live_robot import make_onboard
from tests.support.manual_clock import ManualClock
from tests.support.models import ARM, BASE, actuation_model

STALLS = st.sampled_from([0.12, 0.31, 1.0, 2.5, 30.0])
STANDS = VehicleState(Pose(0.0, 0.0, 0.0), 0.0, 0.0)


@dataclass(frozen=True)
class Arrived:
    """What arrives during the stall."""

    signals: frozenset[str]
    pose: bool
    nodes: frozenset[PartName]
    order: int


ARRIVED = st.builds(
    Arrived,
    signals=st.frozensets(st.sampled_from(sorted(GOOD))),
    pose=st.booleans(),
    nodes=st.frozensets(st.sampled_from([BASE, ARM])),
    order=st.integers(0, 1_000),
)


class Robot:
    """A submitter, its clock and its tick."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.ticked_at: Instant = 0
        self.onboard = make_onboard(actuation_model(), 0)
        catch_up = CatchUp(self.clock, self._tick_due)
        refused = RefusedReadings()
        self.submitter = Submitter(self.onboard, self.clock, self._note, catch_up, refused)
        self.kinds: list[str] = []
        everything = Arrived(frozenset(GOOD), True, frozenset({BASE, ARM}), 0)
        self.take(everything)

    def _tick_due(self) -> Instant:
        return self.ticked_at + seconds(0.05)

    def _note(self, step: Step) -> None:
        self.kinds += [event.kind for event in step.outputs.events]

    def take(self, arrived: Arrived) -> None:
        """Take in what arrived, in its order."""
        given: list[Readings | VehicleReport | NodeReport] = [
            *(Readings((Reading(name, GOOD[name]),), "pad") for name in sorted(arrived.signals)),
            *(
                NodeReport(n, LifecycleState.INACTIVE, reachable=True)
                for n in sorted(arrived.nodes)
            ),
            *([VehicleReport(STANDS)] if arrived.pose else []),
        ]
        cut = arrived.order % (len(given) or 1)
        for item in given[cut:] + given[:cut]:
            self.submitter.submit(item)

    def stall(self, by_s: float) -> None:
        """Let time pass in which nothing runs; then the deadlines come first."""
        self.clock.stall(by_s)
        self.submitter.let_pass()

    async def go_on(self) -> None:
        """Let the loop turn as usual for as long as deadlines may wait."""
        run = asyncio.create_task(self.submitter.run())
        self.ticked_at = self.clock.now()
        await self.clock.advance(MOST_WINDOWS * WINDOW / 1e9)
        run.cancel()
        await asyncio.wait([run])

    @property
    def wrong(self) -> tuple[object, ...]:
        """Return what is wrong with the robot."""
        core = self.onboard.core
        stale = frozenset(name for name, view in core.signals().items() if view.stale)
        return core.system_state().errors, stale, frozenset(core.driving.holds)


@settings(max_examples=200)
@given(stall_s=STALLS, arrived=ARRIVED)
def test_what_arrived_during_a_stall_is_never_too_old_and_the_rest_is(
    stall_s: float, arrived: Arrived
) -> None:
    async def live() -> Robot:
        robot = Robot()
        robot.stall(stall_s)
        robot.take(arrived)
        assert "error.raised" not in robot.kinds, "judged before all was taken in"
        await robot.go_on()
        return robot

    robot = asyncio.run(live())
    stale = {name for name in GOOD if name not in arrived.signals and stall_s > 2.0}
    holds = {"error"} if stale else set()
    if not arrived.pose and stall_s > 0.2:
        holds.add("vehicle")
    errors = ("STALE_DATA",) if stale else ()
    assert robot.wrong == (errors, stale, holds)


@settings(max_examples=50)
@given(stalls=st.lists(STALLS, min_size=5, max_size=8))
def test_however_often_the_loop_stalls_what_does_not_come_is_told_in_the_end(
    stalls: list[float],
) -> None:
    robot = Robot()
    for stall_s in stalls:
        robot.stall(stall_s + 2.5)
    assert robot.onboard.core.system_state().errors == ("STALE_DATA",)
