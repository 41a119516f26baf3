"""What ROS hears of parts while they change, in virtual time."""

from typing import Any

import pytest

from domain.inputs import ParametersRequest
from service.event_log import EventLog
from service.ros.interface.interface import RosInterface
from tests.support.models import BASE, nested_model
from tests.support.ros_robot import RosRobot, running_interface, running_ros_robot

WALL_START_NS = 1_767_225_600_000_000_000


def steps(events: list[Any]) -> list[tuple[str, str, str]]:
    """Return transition, start and goal of transition events, by label."""
    return [
        (e["transition"]["label"], e["start_state"]["label"], e["goal_state"]["label"])
        for e in events
    ]


def modes(events: list[Any]) -> list[tuple[str, str]]:
    """Return start and goal of mode events."""
    return [(event["start_mode"]["label"], event["goal_mode"]["label"]) for event in events]


@pytest.mark.parametrize(
    ("name", "type_name", "node", "of_a_node", "latched"),
    [
        ("/actuation/transition_event", "lifecycle_msgs/msg/TransitionEvent", "actuation", 0, 0),
        ("/drive_base/transition_event", "lifecycle_msgs/msg/TransitionEvent", "pilothouse", 1, 0),
        ("/actuation/mode_event", "system_modes_msgs/msg/ModeEvent", "actuation", 0, 0),
        ("/drive_base/mode_event", "system_modes_msgs/msg/ModeEvent", "pilothouse", 0, 0),
        (
            "/drive_base/transition_request_info",
            "lifecycle_msgs/msg/TransitionEvent",
            "pilothouse",
            0,
            1,
        ),
        ("/actuation/mode_request_info", "system_modes_msgs/msg/ModeEvent", "actuation", 0, 1),
    ],
)
def test_the_topics_of_parts(
    name: str, type_name: str, node: str, of_a_node: int, latched: int
) -> None:
    topic = RosRobot().interface.topics[name]

    assert (topic.type, topic.node) == (type_name, node)
    assert (topic.of_a_node, topic.latched) == (bool(of_a_node), bool(latched))


async def test_a_node_is_followed_through_every_state_and_mode(robot: RosRobot) -> None:
    transitions = robot.hear("/drive_base/transition_event")
    mode_events = robot.hear("/drive_base/mode_event")

    await robot.change_mode("drive_base", "FAST")

    assert steps(transitions) == [
        ("configure", "unconfigured", "configuring"),
        ("", "configuring", "inactive"),
        ("activate", "inactive", "activating"),
        ("", "activating", "active"),
    ]
    assert modes(mode_events) == [("", "FAST")]


async def test_a_system_passes_through_what_it_is_inferred_to_be(robot: RosRobot) -> None:
    transitions = robot.hear("/actuation/transition_event")
    mode_events = robot.hear("/actuation/mode_event")

    await robot.change_mode("actuation", "PERFORMANCE")

    assert steps(transitions) == [
        ("", "unconfigured", "activating"),
        ("", "activating", "active"),
    ]
    assert modes(mode_events) == [("", "PERFORMANCE")]


async def test_a_mode_alone_is_no_transition(robot: RosRobot) -> None:
    await robot.change_mode("drive_base", "FAST")
    transitions = robot.hear("/drive_base/transition_event")
    mode_events = robot.hear("/drive_base/mode_event")

    await robot.change_mode("drive_base", "SLOW")

    assert (steps(transitions), modes(mode_events)) == ([], [("FAST", "SLOW")])


async def test_an_event_has_the_wall_time_at_which_it_happened(robot: RosRobot) -> None:
    transitions = robot.hear("/drive_base/transition_event")
    await robot.clock.advance(2.0)

    await robot.change_mode("drive_base", "FAST")

    begun, configured = (event["timestamp"] - WALL_START_NS for event in transitions[:2])
    assert (begun, configured) == (2_000_000_000, 2_300_000_000)


async def test_a_request_is_told_for_the_part_and_for_all_below_it(robot: RosRobot) -> None:
    heard = {
        part: robot.hear(f"/{part}/mode_request_info")
        for part in ("actuation", "drive_base", "manipulator")
    }

    await robot.change_mode("actuation", "PERFORMANCE")

    assert {part: modes(events) for part, events in heard.items()} == {
        "actuation": [("", "PERFORMANCE")],
        "drive_base": [("", "FAST")],
        "manipulator": [("", "STRONG")],
    }


async def test_a_part_whose_target_stays_is_not_told_again_but_the_asked_one_is(
    robot: RosRobot,
) -> None:
    await robot.change_mode("drive_base", "FAST")
    system = robot.hear("/actuation/mode_request_info")
    node = robot.hear("/drive_base/mode_request_info")
    told = len(node)

    await robot.change_mode("actuation", "PERFORMANCE")
    await robot.change_mode("actuation", "PERFORMANCE")

    assert len(system) == 2
    assert len(node) == told


async def test_a_transition_request_names_the_transition_and_its_goal(robot: RosRobot) -> None:
    system = robot.hear("/actuation/transition_request_info")
    node = robot.hear("/manipulator/transition_request_info")

    await robot.call("/actuation/change_state", {"transition": {"label": "configure"}})

    assert steps(system) == [("configure", "unconfigured", "inactive")]
    assert steps(node) == [("", "unconfigured", "inactive")]


async def test_a_system_that_is_activated_is_asked_for_a_state_and_its_nodes_for_modes(
    robot: RosRobot,
) -> None:
    system = robot.hear("/actuation/transition_request_info")
    base = robot.hear("/drive_base/mode_request_info")
    arm = robot.hear("/manipulator/transition_request_info")

    await robot.call("/actuation/change_state", {"transition": {"label": "activate"}})

    assert [step[2] for step in steps(system)] == ["active"]
    assert modes(base) == [("", "__DEFAULT__")]
    assert [step[2] for step in steps(arm)] == ["inactive"]


async def test_parameters_that_are_set_are_no_request_for_a_state(robot: RosRobot) -> None:
    topics = [robot.hear(name) for name in robot.interface.topics if "request_info" in name]

    robot.supervisor.submit(ParametersRequest(BASE, {"max_speed": 0.3}))
    await robot.clock.advance(1.0)

    assert topics == [[]] * 6


async def test_requests_reach_the_parts_of_systems_in_systems() -> None:
    async with running_ros_robot(nested_model()) as robot:
        inner = robot.hear("/actuation/mode_request_info")
        node = robot.hear("/drive_base/mode_request_info")
        await robot.change_mode("robot", "RACE")

    assert modes(inner) == [("", "PERFORMANCE")]
    assert modes(node) == [("", "FAST")]


async def test_who_comes_late_gets_the_last_request_and_no_older_event(robot: RosRobot) -> None:
    await robot.change_mode("actuation", "MODERATE")
    await robot.change_mode("actuation", "PERFORMANCE")

    assert modes(robot.hear("/actuation/mode_request_info")) == [("MODERATE", "PERFORMANCE")]
    assert modes(robot.hear("/drive_base/mode_request_info")) == [("SLOW", "FAST")]
    assert robot.hear("/actuation/mode_event") == []


async def test_an_interface_that_begins_late_knows_also_what_no_event_tells_any_more(
    robot: RosRobot,
) -> None:
    robot.supervisor.events = EventLog(capacity=1, before=robot.supervisor.events.newest)
    await robot.change_mode("actuation", "PERFORMANCE")
    late = RosInterface(robot.supervisor)

    async with running_interface(late):
        heard: list[Any] = []
        late.listen("/drive_base/mode_request_info", heard.append)

    assert modes(heard) == [("", "FAST")]


async def test_an_interface_that_begins_late_knows_what_was_asked_before(robot: RosRobot) -> None:
    await robot.change_mode("actuation", "PERFORMANCE")
    await robot.change_mode("drive_base", "SLOW")
    late = RosInterface(robot.supervisor)
    early_ear: list[Any] = []
    late.listen("/drive_base/mode_request_info", early_ear.append)

    async with running_interface(late):
        late_ear: list[Any] = []
        late.listen("/actuation/mode_request_info", late_ear.append)

    assert modes(early_ear) == [("", "SLOW")]
    assert modes(late_ear) == [("", "PERFORMANCE")]
