import pickle
from typing import TypeAlias

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from api.simulation import simulation_job
from domain.commands import AskTransition, Drive, NodeCommand
from domain.errors import UnknownPartError
from domain.inputs import NodeAnswer, NodeReport, Readings, VehicleReport
from domain.lifecycle import LifecycleState, Transition
from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault, NodeSettings
from domain.simulation.robot import RobotMessage, SimulatedRobot
from domain.simulation.vehicle_settings import Noise, Plant, VehicleSettings
from domain.state_and_mode import PartName
from domain.timebase import Instant, seconds, to_seconds
from domain.vehicle import DriveCommand, Pose
from tests.support.live_robot import make_onboard
from tests.support.models import ARM, BASE, actuation_model

MODEL = actuation_model()
EMPTY = SmhModel({}, {})
NOISY = VehicleSettings(Pose(1.0, 2.0, 0.5), Plant(noise=Noise(position_m=0.1, seed=3)))


def heard(robot: SimulatedRobot, from_s: float, until_s: float) -> list[tuple[float, RobotMessage]]:
    """Return what is said in a time, when, waking only when the robot wants it."""
    end = seconds(until_s)
    said: list[tuple[float, RobotMessage]] = []
    now = seconds(from_s)
    while (due := robot.wake_at()) <= end:
        now = max(now, due)
        said += [(to_seconds(now), message) for message in robot.advance(now)]
    return said


def test_at_one_instant_nodes_come_first_then_signals_then_the_vehicle() -> None:
    kinds = [type(message) for message in SimulatedRobot(MODEL, 0, mock=True).advance(0)]

    assert kinds == [NodeReport, NodeReport, Readings, VehicleReport]


def test_each_part_speaks_at_its_own_pace() -> None:
    said = heard(SimulatedRobot(MODEL, 0, mock=True), 0.0, 1.0)

    assert len([m for _, m in said if isinstance(m, Readings)]) == 11
    assert len([m for _, m in said if isinstance(m, VehicleReport)]) == 21
    assert {at for at, m in said if isinstance(m, NodeReport)} == {0.0}


def test_a_robot_without_mock_signals_has_none() -> None:
    robot = SimulatedRobot(MODEL, 0)

    assert robot.mock is None
    assert not [m for _, m in heard(robot, 0.0, 1.0) if isinstance(m, Readings)]


@pytest.mark.parametrize(
    ("mock", "what"), [(False, ("nodes", "vehicle")), (True, ("nodes", "signals", "vehicle"))]
)
def test_it_says_what_of_it_is_simulated(mock: bool, what: tuple[str, ...]) -> None:
    assert SimulatedRobot(MODEL, 0, mock=mock).what == what


def test_a_command_reaches_the_node_that_it_is_for() -> None:
    robot = SimulatedRobot(MODEL, 0)
    heard(robot, 0.0, 0.0)
    robot.handle(AskTransition(7, BASE, Transition.CONFIGURE), 0)
    said = [(at, m) for at, m in heard(robot, 0.0, 1.0) if isinstance(m, NodeAnswer | NodeReport)]

    assert said == [
        (0.0, NodeAnswer(7, BASE, True)),
        (0.0, NodeReport(BASE, state=LifecycleState.CONFIGURING)),
        (0.3, NodeReport(BASE, state=LifecycleState.INACTIVE)),
    ]


def test_a_command_to_drive_reaches_the_vehicle() -> None:
    robot = SimulatedRobot(MODEL, 0)
    heard(robot, 0.0, 0.0)
    robot.handle(Drive(DriveCommand(2.0, 0.0)), seconds(0.02))
    (_, report), *_ = heard(robot, 0.02, 0.05)

    assert isinstance(report, VehicleReport)
    assert report.state.speed_mps == 2.0
    assert report.state.pose.x_m == pytest.approx(0.06)


def test_what_a_command_leads_to_at_once_is_due_at_once() -> None:
    robot = SimulatedRobot(MODEL, 0)
    heard(robot, 0.0, 0.0)
    robot.handle(AskTransition(1, BASE, Transition.CONFIGURE), seconds(0.03))

    assert robot.wake_at() == seconds(0.03)


def test_what_is_done_to_a_signal_is_due_at_once() -> None:
    robot = SimulatedRobot(MODEL, 0, mock=True)
    heard(robot, 0.0, 0.0)
    assert robot.mock is not None
    robot.mock.hold("estop", True, seconds(0.03))

    assert robot.wake_at() == seconds(0.03)


def test_after_it_was_advanced_it_wants_to_be_woken_later() -> None:
    robot = SimulatedRobot(MODEL, 0, mock=True)
    robot.advance(seconds(0.12))

    assert robot.wake_at() == seconds(0.15)


def test_settings_of_node_and_vehicle_hold() -> None:
    nodes = {ARM: NodeSettings(fault=Fault.DIE)}
    vehicle = VehicleSettings(Pose(1.0, 2.0, 0.5))
    said = heard(SimulatedRobot(MODEL, 0, nodes, vehicle), 0.0, 1.0)

    assert NodeReport(ARM, reachable=False) in [message for _, message in said]
    assert {m.state.pose for _, m in said if isinstance(m, VehicleReport)} == {Pose(1.0, 2.0, 0.5)}


def test_a_vehicle_of_which_nothing_is_said_stands_at_the_origin() -> None:
    (report,) = SimulatedRobot(EMPTY, 0).advance(0)

    assert isinstance(report, VehicleReport)
    assert report.state.pose == Pose(0.0, 0.0, 0.0)


def test_settings_of_a_node_that_is_not_there_are_refused() -> None:
    with pytest.raises(UnknownPartError, match="nowhere"):
        SimulatedRobot(MODEL, 0, {PartName("nowhere"): NodeSettings()})


def copy_of(robot: SimulatedRobot) -> SimulatedRobot:
    """Return a copy as a simulation that begins with the live robot makes it."""
    copied: SimulatedRobot
    _, copied = pickle.loads(simulation_job.copy_of(make_onboard(MODEL, 0), robot))
    return copied


Command: TypeAlias = NodeCommand | Drive
COMMANDS = st.one_of(
    st.builds(
        lambda request, node, transition: AskTransition(request, node, transition),
        st.integers(0, 99),
        st.sampled_from([BASE, ARM]),
        st.sampled_from([Transition.CONFIGURE, Transition.ACTIVATE, Transition.CLEANUP]),
    ),
    st.builds(lambda v, a: Drive(DriveCommand(v, a)), st.floats(-3, 3), st.floats(-0.6, 0.6)),
)
SCRIPTS = st.lists(st.tuples(st.integers(0, 2_000), COMMANDS), max_size=8).map(
    lambda script: sorted(script, key=lambda item: item[0])
)


def play(
    robot: SimulatedRobot, script: list[tuple[int, Command]], until: Instant
) -> list[tuple[float, RobotMessage]]:
    """Give commands at their times in ms, and return what was said, when."""
    said = []
    for at_ms, command in script:
        at = seconds(at_ms / 1000)
        said += heard(robot, 0.0, to_seconds(at))
        robot.handle(command, at)
    return said + heard(robot, 0.0, to_seconds(until))


@settings(max_examples=40)
@given(before=SCRIPTS, after=SCRIPTS)
def test_a_copy_made_half_way_goes_on_like_the_original(
    before: list[tuple[int, Command]], after: list[tuple[int, Command]]
) -> None:
    robot = SimulatedRobot(MODEL, 0, vehicle=NOISY, mock=True)
    play(robot, before, seconds(2.0))
    copied = copy_of(robot)
    later = [(2_000 + at_ms, command) for at_ms, command in after]

    assert play(copied, later, seconds(5.0)) == play(robot, later, seconds(5.0))


def test_what_happens_to_a_copy_does_not_happen_to_the_original() -> None:
    robot = SimulatedRobot(MODEL, 0, vehicle=NOISY, mock=True)
    untouched = SimulatedRobot(MODEL, 0, vehicle=NOISY, mock=True)
    copied = copy_of(robot)
    assert copied.mock is not None
    copied.mock.hold("estop", True, 0)
    copied.nodes.set_fault(BASE, Fault.DIE, 0)
    play(copied, [(0, Drive(DriveCommand(2.0, 0.3)))], seconds(1.0))

    assert heard(robot, 0.0, 2.0) == heard(untouched, 0.0, 2.0)
