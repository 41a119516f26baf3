"""Whatever stops whatever vehicle: a vehicle that stands in time is no news, any other is told.

Judged by what the vehicle reports, and by the time that is promised for a stop: 1 s, and 1.25 times
what the assumed braking needs.
"""

import os
from collections.abc import Callable
from dataclasses import dataclass

import hypothesis.strategies as st
import pytest
from hypothesis import assume, event, given

from domain.inputs import Reading, Readings
from domain.parts.system_model import SmhModel
from domain.simulation.vehicle_settings import Plant, VehicleSettings
from domain.supervision import SupervisionSettings
from domain.tasks.settings import TaskSettings
from domain.timebase import seconds, to_seconds
from service.files.robot_settings import SignalsBlock
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.paths import straight

SOAK = os.environ.get("PILOTHOUSE_SOAK") == "1"
STANDS_MPS = 0.05
PERIOD_S = 0.05
LONGEST_S = 60.0

STOPS: dict[str, Callable[[CoreRobot], object]] = {
    "estop": lambda robot: robot.give(Readings((Reading("estop", True),), "button")),
    "emergency stop": lambda robot: robot.stop(),
    "battery": lambda robot: robot.read(battery_level=0.1),
    "hold": lambda robot: robot.hold(),
    "cancel": lambda robot: robot.cancel_task(),
}


@dataclass(frozen=True, slots=True)
class Case:
    """A vehicle, what is assumed of it, and how it is stopped."""

    plant: Plant
    braking_mps2: float
    speed_mps: float
    driven_s: float
    stop: str


PLANTS = st.builds(
    Plant,
    acceleration_mps2=st.sampled_from([None, 0.5, 3.0]),
    braking_mps2=st.one_of(st.none(), st.floats(0.02, 5.0)),
    speed_lag_s=st.sampled_from([0.0, 0.2, 1.0, 3.0]),
    delay=st.sampled_from([0.0, 0.1, 0.7, 2.0]).map(seconds),
)
CASES = st.builds(
    Case,
    plant=PLANTS,
    braking_mps2=st.floats(0.2, 3.0),
    speed_mps=st.floats(0.5, 8.0),
    driven_s=st.floats(2.0, 10.0),
    stop=st.sampled_from(sorted(STOPS)),
)


@pytest.mark.timeout(0 if SOAK else 60)
@given(CASES)
def test_a_stop_is_told_exactly_if_it_takes_longer_than_promised(case: Case) -> None:
    robot = CoreRobot(
        SmhModel({}, {}),
        SupervisionSettings(
            SignalsBlock(stale_after_s=0.0).to_domain(),
            tasks=TaskSettings(braking_mps2=case.braking_mps2),
        ),
        vehicle=VehicleSettings(plant=case.plant),
    )
    robot.read(**GOOD)
    robot.submit_task(straight(300), speed_mps=case.speed_mps)
    robot.advance(case.driven_s)
    stopped_at, speed_mps = robot.now, reported(robot)
    assume(speed_mps >= STANDS_MPS)
    STOPS[case.stop](robot)
    allowed_s = 1.0 + 1.25 * speed_mps / case.braking_mps2

    stood_at = None
    while stood_at is None and to_seconds(robot.now - stopped_at) < LONGEST_S:
        robot.advance(PERIOD_S)
        if reported(robot) < STANDS_MPS:
            stood_at = robot.now

    told = [each.kind for each in robot.events if each.kind.startswith("vehicle.st")]
    took_s = None if stood_at is None else to_seconds(stood_at - stopped_at)
    if took_s is not None and took_s < allowed_s:
        event("stands in time")
        assert told == []
    elif took_s is None or took_s > allowed_s + PERIOD_S:
        event("too late" if took_s else "never")
        assert told == ["vehicle.still_moving", *(["vehicle.stopped"] if took_s else [])]
        (found,) = robot.happened("vehicle.still_moving")
        assert found["after_s"] == pytest.approx(allowed_s, abs=0.001)


def reported(robot: CoreRobot) -> float:
    """Return the speed that the vehicle reported last, m/s."""
    state = robot.core.driving.vehicle.state
    return 0.0 if state is None else abs(state.speed_mps)


@given(
    st.lists(st.tuples(st.floats(0.0, 3.0), st.booleans()), min_size=1, max_size=12),
    st.floats(0.05, 5.0),
)
def test_whatever_it_does_under_the_stop_an_alarm_never_outlasts_a_standstill(
    moves: list[tuple[float, bool]], speed_mps: float
) -> None:
    """The reason is there only while the newest pose does not show a standstill, and events agree.

    Args:
        moves: Pieces of the time after the stop: how long, and whether the vehicle is heard.
        speed_mps: Of the vehicle when it is stopped.
    """
    robot = CoreRobot(
        SmhModel({}, {}),
        SupervisionSettings(SignalsBlock(stale_after_s=0.0).to_domain()),
        vehicle=VehicleSettings(plant=Plant(braking_mps2=0.3)),
    )
    robot.read(**GOOD)
    robot.submit_task(straight(300), speed_mps=speed_mps if speed_mps > 0.5 else 0.5)
    robot.advance(6.0)
    robot.stop()
    for lasts_s, is_heard in moves:
        robot.lose_pose(lost=not is_heard)
        robot.advance(lasts_s)
        found = robot.core.driving.vehicle.still_moving
        kinds = [each.kind for each in robot.events if each.kind.startswith("vehicle.st")]
        if robot.core.driving.watch.stands:
            assert found is None
            assert kinds == [] or kinds[-1] == "vehicle.stopped"
        elif found is not None:
            assert robot.core.system_state().reasons[0] is found
            expected = (
                "vehicle.standstill_unknown"
                if robot.core.driving.watch.is_lost
                else "vehicle.still_moving"
            )
            assert kinds[-1] == expected
