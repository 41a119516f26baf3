"""What conditions see of a robot, told as an operator meets it."""

import pytest

from domain.conditions.condition import Condition
from domain.conditions.evaluation import Truth, evaluate
from domain.conditions.facts import Observation
from domain.conditions.tree import comparisons
from domain.health.signals import SignalKind, SignalSettings, SignalSpec, default_signals
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.simulation.node_settings import Fault
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from domain.timebase import seconds
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import ARM, BASE, actuation_model

ODOMETER = SignalSettings(SignalSpec("odometer", SignalKind.NUMBER, "km"), stale_after=0)


@pytest.fixture
def robot() -> CoreRobot:
    settings = SupervisionSettings(signals=(*default_signals(), ODOMETER))
    return CoreRobot(actuation_model(), settings)


def _truth(robot: CoreRobot, text: str) -> Truth:
    return evaluate(Condition(text), robot.core.facts)


def _seen(robot: CoreRobot, subject: str) -> Observation:
    (leaf,) = comparisons(Condition(f"{subject} == 0").root)
    return robot.core.facts.observe(leaf.subject)


def test_a_signal_is_unknown_until_it_is_seen_and_when_it_is_stale(robot: CoreRobot) -> None:
    assert _seen(robot, "battery_level") == Observation(doubt="was never seen")

    robot.read(**GOOD)
    assert _seen(robot, "battery_level") == Observation(1.0)
    assert _seen(robot, "temperature") == Observation(30.0, unit="°C")
    assert _truth(robot, "signal_strength == CONNECTED and not estop") is Truth.TRUE

    robot.advance(2.1)
    assert _seen(robot, "battery_level") == Observation(1.0, "is stale")
    assert _truth(robot, "signal_strength == CONNECTED") is Truth.UNKNOWN


def test_a_signal_that_is_never_stale_is_unknown_all_the_same_until_it_is_seen(
    robot: CoreRobot,
) -> None:
    assert _truth(robot, "odometer >= 0") is Truth.UNKNOWN

    robot.read(odometer=7.5)
    robot.advance(100)

    assert _seen(robot, "odometer") == Observation(7.5, unit="km")


def test_a_node_has_a_state_and_a_mode_once_it_is_known(robot: CoreRobot) -> None:
    assert _seen(robot, "drive_base.state").value == "unconfigured"
    assert _truth(robot, "drive_base.mode == FAST") is Truth.FALSE
    assert _truth(robot, "drive_base.mode not in [SLOW, FAST]") is Truth.TRUE

    robot.ask_mode("drive_base", "FAST")
    robot.advance(5)

    assert _truth(robot, "drive_base.state == active and drive_base.mode == FAST") is Truth.TRUE
    assert _truth(robot, "drive_base.parameters.max_speed > 0.5") is Truth.TRUE
    assert _truth(robot, "drive_base.parameters.controller == MPC") is Truth.TRUE
    assert _truth(robot, "drive_base.converged and drive_base.reachable") is Truth.TRUE


def test_of_a_silent_node_only_that_it_is_silent_is_known(robot: CoreRobot) -> None:
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(5)
    robot.fault("drive_base", Fault.DIE)
    robot.advance(5)

    for text in ("state == active", "mode == FAST", "parameters.max_speed < 1"):
        assert _truth(robot, f"drive_base.{text}") is Truth.UNKNOWN
    assert _truth(robot, "not drive_base.reachable") is Truth.TRUE
    assert _truth(robot, "drive_base.errors.UNREACHABLE") is Truth.TRUE
    assert _truth(robot, "not actuation.reachable and manipulator.reachable") is Truth.TRUE
    assert _truth(robot, "actuation.state == active") is Truth.UNKNOWN
    assert _seen(robot, "drive_base.state").doubt == "is unreachable"
    assert _seen(robot, "drive_base.mode").doubt == "is unknown: drive_base is unreachable"
    assert "drive_base is unreachable" in _seen(robot, "drive_base.parameters.max_speed").doubt


def test_a_parameter_is_unknown_until_it_is_reported_and_if_it_is_an_array(
    robot: CoreRobot,
) -> None:
    robot.give(NodeReport(ARM, LifecycleState.ACTIVE, parameters={"gains": (1.0, 2.0)}))

    assert _seen(robot, "manipulator.parameters.age").doubt == "was never reported"
    assert _seen(robot, "manipulator.parameters.gains").doubt.startswith("is an array")
    assert "only nodes" in _seen(robot, "actuation.parameters.x").doubt


def test_errors_the_state_of_the_robot_and_holds_are_never_unknown(robot: CoreRobot) -> None:
    assert _truth(robot, "error.STALE_DATA and robot.state == ERROR and hold.error") is Truth.TRUE
    assert _truth(robot, "error.ESTOP or hold.operator") is Truth.FALSE

    robot.read(**GOOD, odometer=1.0)
    robot.hold("operator")

    assert _truth(robot, "robot.state == IDLE and hold.operator") is Truth.TRUE
    assert _truth(robot, "error.STALE_DATA or error.NO_SUCH_ERROR") is Truth.FALSE
    assert _seen(robot, "hold.operator").since == robot.now


def test_an_error_is_there_since_it_was_raised(robot: CoreRobot) -> None:
    robot.read(**GOOD)
    robot.advance(1)
    robot.read(battery_level=0.4)
    robot.advance(0.5)

    assert _seen(robot, "error.BATTERY_LOW") == Observation(value=True, since=seconds(1))


def test_the_task_has_a_status_and_progress_and_none_has_no_progress(robot: CoreRobot) -> None:
    assert _truth(robot, "task.status == NO_TASK and task.progress == 0") is Truth.TRUE

    robot.read(**GOOD, odometer=1.0)
    robot.advance(0.1)
    robot.submit_task()

    assert _truth(robot, "task.status == RUNNING_TASK and robot.state == RUNNING") is Truth.TRUE
    for _ in range(8):
        robot.read(**GOOD)
        robot.advance(1)
    assert _truth(robot, "task.progress > 0.1 and vehicle.speed_mps > 1") is Truth.TRUE
    assert _seen(robot, "vehicle.speed_mps").unit == "m/s"


def test_an_old_pose_makes_everything_about_the_vehicle_unknown(robot: CoreRobot) -> None:
    robot.advance(0.2)
    assert _truth(robot, "vehicle.speed_mps < 0.05 and vehicle.x_m == 0") is Truth.TRUE

    robot.lose_pose()
    robot.advance(0.5)

    for name in ("speed_mps", "x_m", "y_m", "yaw_rad", "steering_angle_rad"):
        assert _seen(robot, f"vehicle.{name}").doubt == "is unknown: the pose is too old"
    assert _truth(robot, "hold.vehicle") is Truth.TRUE


def test_what_does_not_exist_is_in_doubt(robot: CoreRobot) -> None:
    for subject in ("nothing", "nobody.state", "nobody.errors.SILENT"):
        assert _seen(robot, subject).doubt == "does not exist"


def test_a_node_that_processes_an_error_has_that_error(robot: CoreRobot) -> None:
    robot.give(NodeReport(BASE, LifecycleState.ERROR_PROCESSING))

    assert _truth(robot, "drive_base.errors.ERROR_PROCESSING") is Truth.TRUE
    assert _truth(robot, "actuation.errors.ERROR_PROCESSING") is Truth.FALSE
    assert robot.core.part(PartName("drive_base")).actual.state is LifecycleState.ERROR_PROCESSING
