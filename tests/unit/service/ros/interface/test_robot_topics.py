from domain.inputs import HoldRequest, Reading, TaskRequest
from tests.support.paths import straight
from tests.support.ros_robot import RosRobot


async def test_the_system_state_is_told_twenty_times_a_second(robot: RosRobot) -> None:
    heard = robot.hear("/system_state")

    await robot.clock.advance(10)

    assert len(heard) == 200
    assert {(message["state"], message["error_code"]) for message in heard} == {(0, 0)}


async def test_a_message_is_stamped_with_the_moment_of_its_frame(robot: RosRobot) -> None:
    heard = robot.hear("/system_state")

    await robot.clock.advance(0.05)

    (message,) = heard
    stamp = {"sec": 1_767_225_600, "nanosec": 50_000_000}
    assert message["header"] == {"stamp": stamp, "frame_id": ""}


async def test_an_error_is_told_with_its_bits_before_the_next_tick(robot: RosRobot) -> None:
    await robot.clock.advance(0.01)
    heard = robot.hear("/system_state")

    robot.supervisor.readings.submit([Reading("battery_level", 0.2), Reading("estop", value=True)])
    await robot.clock.advance(0)

    assert [(message["state"], message["error_code"]) for message in heard] == [(2, 3)]


async def test_a_task_shows_in_state_and_status(robot: RosRobot) -> None:
    await robot.clock.advance(1)
    robot.supervisor.submit(TaskRequest(straight(), 0, "pure_pursuit", 1.0))
    states, statuses = robot.hear("/system_state"), robot.hear("/task_planner_status")

    await robot.clock.advance(0.1)
    assert (states[-1]["state"], statuses[-1]["status"]) == (1, 2)

    robot.supervisor.submit(HoldRequest("operator", "lunch"))
    await robot.clock.advance(0.1)
    assert (states[-1]["state"], statuses[-1]["status"]) == (1, 1)


async def test_diagnostics_come_once_a_second(robot: RosRobot) -> None:
    heard = robot.hear("/diagnostics")

    await robot.clock.advance(10)

    at = [message["header"]["stamp"]["sec"] - 1_767_225_600 for message in heard]
    assert at == list(range(10))


async def test_diagnostics_come_at_once_when_the_state_of_the_robot_changes(
    robot: RosRobot,
) -> None:
    heard = robot.hear("/diagnostics")
    await robot.clock.advance(0.51)
    before = len(heard)

    robot.supervisor.readings.submit([Reading("estop", value=True)])
    await robot.clock.advance(0)

    assert len(heard) == before + 1
    assert heard[-1]["status"][0]["level"] == 2


def test_diagnostics_are_made_on_demand_only() -> None:
    topics = RosRobot().interface.topics

    assert topics["/diagnostics"].on_demand
    assert not topics["/system_state"].on_demand


def test_all_are_of_the_own_node_and_nothing_is_latched() -> None:
    topics = RosRobot().interface.topics

    assert {
        name: (topics[name].type, topics[name].node, topics[name].of_a_node, topics[name].latched)
        for name in ("/system_state", "/task_planner_status", "/diagnostics")
    } == {
        "/system_state": ("pilothouse_msgs/msg/SystemState", "pilothouse", False, False),
        "/task_planner_status": (
            "pilothouse_msgs/msg/TaskStatus",
            "pilothouse",
            False,
            False,
        ),
        "/diagnostics": ("diagnostic_msgs/msg/DiagnosticArray", "pilothouse", False, False),
    }
