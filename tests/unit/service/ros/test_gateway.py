"""Pilothouse in a ROS 2 graph in memory, in virtual time."""

import asyncio
import logging
from collections.abc import AsyncIterator
from typing import Any

import pytest

from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.state_and_mode import DEFAULT_MODE, PartName
from service.ros.gateway import RosGateway
from service.ros.graph.graph import Fields, Lane, Qos
from service.ros.interface.endpoints import OfferedTopic
from service.ros.interface.message_sets import MessageSet
from service.ros.interface.settings import USUAL_SETTINGS, InterfaceSettings
from tests.support.live_robot import running
from tests.support.manual_clock import settle
from tests.support.models import inactive
from tests.support.ros_graph import FakeGraph
from tests.support.ros_robot import RosRobot

NOT_BUILT = (
    "system_modes_msgs/srv/ChangeMode",
    "system_modes_msgs/srv/GetMode",
    "system_modes_msgs/srv/GetAvailableModes",
    "system_modes_msgs/msg/ModeEvent",
    "pilothouse_msgs/msg/SystemState",
    "pilothouse_msgs/msg/TaskStatus",
    "pilothouse_msgs/msg/BatteryLevel",
    "pilothouse_msgs/msg/EmergencyStop",
    "pilothouse_msgs/msg/GpsAccuracy",
    "pilothouse_msgs/msg/SignalStrength",
    "pilothouse_msgs/msg/Temperature",
    "pilothouse_msgs/srv/DriveWaypoints",
    "pilothouse_msgs/srv/StartTask",
)
"""What no distribution of ROS 2 has."""

UNSENDABLE: Fields = {"status": "?"}


class Offered:
    """The example robot, offered in a graph."""

    def __init__(
        self,
        missing: tuple[str, ...] = (),
        model: SmhModel | None = None,
        mapped: tuple[str, ...] = (),
        settings: InterfaceSettings = USUAL_SETTINGS,
    ) -> None:
        self.robot = RosRobot(model, settings)
        self.clock = self.robot.clock
        self.graph = FakeGraph(self.clock, missing)
        self.gateway = RosGateway(self.robot.interface, self.graph, self.clock, mapped)
        # It only lets others have their turn in between, and there are none.
        for _ in self.gateway.offer().__await__():
            pass

    async def call(self, service: str, request: Fields) -> Fields:
        """Call a service as somebody in the graph; what is asked takes a few seconds."""
        asked = asyncio.create_task(self.graph.call(service, request))
        await self.clock.advance(3.0)
        return await asked


async def run(offered: Offered) -> AsyncIterator[Offered]:
    """Let everything run as long as the generator is open."""
    async with running(offered.robot.supervisor):
        publishing = asyncio.create_task(offered.gateway.run(), name="gateway")
        await settle()
        yield offered
        publishing.cancel()
        await asyncio.gather(publishing, return_exceptions=True)


@pytest.fixture
async def native() -> AsyncIterator[Offered]:
    async for offered in run(Offered()):
        yield offered


@pytest.fixture
async def carried() -> AsyncIterator[Offered]:
    async for offered in run(Offered(NOT_BUILT)):
        yield offered


def test_each_system_is_a_node_and_all_else_is_one_more() -> None:
    graph = Offered().graph

    assert graph.nodes == {"actuation": Lane.GATEWAY, "pilothouse": Lane.GATEWAY}


def test_what_real_nodes_have_themselves_is_left_to_them() -> None:
    types = Offered().graph.types

    assert types["/actuation/get_state"] == "lifecycle_msgs/srv/GetState"
    assert "/actuation/transition_event" in types
    assert "/drive_base/get_mode" in types
    assert "/drive_base/get_state" not in types
    assert "/drive_base/transition_event" not in types


def test_where_the_types_are_installed_they_are_used() -> None:
    types = Offered().graph.types

    assert types["/actuation/change_mode"] == "system_modes_msgs/srv/ChangeMode"
    assert types["/drive_base/mode_event"] == "system_modes_msgs/msg/ModeEvent"
    assert types["/system_state"] == "pilothouse_msgs/msg/SystemState"
    assert types["/estop"] == "pilothouse_msgs/msg/EmergencyStop"


def test_where_they_are_not_others_stand_in_and_nothing_else_is_heard() -> None:
    types = Offered(NOT_BUILT).graph.types

    assert types["/actuation/change_mode"] == "lifecycle_msgs/srv/ChangeState"
    assert types["/actuation/get_mode"] == "lifecycle_msgs/srv/GetState"
    assert types["/actuation/get_available_modes"] == "lifecycle_msgs/srv/GetAvailableStates"
    assert types["/drive_base/mode_event"] == "lifecycle_msgs/msg/TransitionEvent"
    assert types["/system_state"] == "diagnostic_msgs/msg/DiagnosticStatus"
    assert types["/task_planner_status"] == "diagnostic_msgs/msg/DiagnosticStatus"
    assert types["/serve_waypoints"] == "diagnostic_msgs/srv/AddDiagnostics"
    assert "/drive_waypoints" not in types
    assert "/estop" not in types


def test_only_requests_and_the_path_are_kept_for_who_comes_late() -> None:
    offered = Offered()
    topics: list[OfferedTopic] = list(offered.robot.interface.topics.values())

    latched = {name for name, qos in offered.graph.qos.items() if qos is Qos.LATCHED}
    requests = {topic.name for topic in topics if topic.name.endswith("request_info")}
    assert latched == requests | {"/pilothouse/path"}
    assert offered.graph.qos["/actuation/mode_event"] is Qos.EVENTS


def test_what_has_no_type_at_all_is_left_out_and_said_once(
    caplog: pytest.LogCaptureFixture,
) -> None:
    missing = (*NOT_BUILT, "diagnostic_msgs/msg/DiagnosticStatus", "std_srvs/srv/Empty")

    types = Offered(missing).graph.types

    assert "/system_state" not in types
    assert "/cancel_tasks" not in types
    (record,) = caplog.records
    assert record.levelno == logging.WARNING
    assert record.getMessage() == (
        "not offered in ROS 2, since these types are not installed: std_srvs/srv/Empty"
    )


def test_what_needs_our_own_types_and_they_are_not_built_is_said_without_a_warning(
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level(logging.INFO)

    Offered(NOT_BUILT)

    offered, heard, *_ = caplog.records
    assert (offered.levelno, heard.levelno) == (logging.INFO, logging.INFO)
    assert offered.getMessage() == (
        "not offered in ROS 2, since these types are not installed: "
        "pilothouse_msgs/srv/DriveWaypoints"
    )
    assert heard.getMessage().startswith("not subscribed to in ROS 2, since these types are not")
    assert "pilothouse_msgs/msg/EmergencyStop" in heard.getMessage()


def test_messages_that_the_robot_file_names_and_that_are_missing_are_a_warning(
    caplog: pytest.LogCaptureFixture,
) -> None:
    missing = [f"gem_state_msgs/msg/{name}Stamped" for name in ("Estop", "SystemState")]

    graph = Offered(tuple(missing), settings=InterfaceSettings(MessageSet.GEM)).graph

    assert graph.types["/system_state"] == "diagnostic_msgs/msg/DiagnosticStatus"
    assert graph.types["/battery_level"] == "gem_state_msgs/msg/BatteryLevelStamped"
    (record,) = caplog.records
    assert record.levelno == logging.WARNING
    assert record.getMessage() == (
        "not subscribed to in ROS 2, since these types are not installed: "
        "gem_state_msgs/msg/EstopStamped"
    )


def test_the_log_lists_what_is_offered(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)

    Offered()

    services, published, subscribed, *parts = [record.getMessage() for record in caplog.records]
    assert services.startswith("ROS 2 services: /cancel_tasks [std_srvs/srv/Empty], /drive_way")
    assert "/system_state [pilothouse_msgs/msg/SystemState]" in published
    assert "/estop [pilothouse_msgs/msg/EmergencyStop]" in subscribed
    assert [line.partition(":")[0] for line in parts] == [
        "ROS 2 /actuation",
        "ROS 2 /drive_base",
        "ROS 2 /manipulator",
    ]
    assert "get_state" in parts[0]
    assert "get_state" not in parts[1]


def test_a_part_with_a_name_that_ros_does_not_allow_is_left_out_and_said_once(
    caplog: pytest.LogCaptureFixture,
) -> None:
    left, odd = PartName("left/arm"), PartName("drive-base")
    nodes = {name: NodeModel(name) for name in (left, odd)}
    system = SystemModel(PartName("2nd"), {DEFAULT_MODE: dict.fromkeys(nodes, inactive())})

    graph = Offered(model=SmhModel(nodes, {system.name: system})).graph

    assert "/left/arm/get_mode" in graph.types
    assert not [name for name in graph.types if "drive-base" in name or "2nd" in name]
    assert set(graph.nodes) == {"pilothouse"}
    (record,) = caplog.records
    assert record.getMessage() == (
        "not offered in ROS 2, since these names are not allowed: /2nd, /drive-base"
    )


def test_a_part_with_a_name_that_is_too_long_for_ros_is_left_out() -> None:
    node = PartName("a" * 230)
    system = SystemModel(PartName("b" * 230), {DEFAULT_MODE: {node: inactive()}})

    graph = Offered(model=SmhModel({node: NodeModel(node)}, {system.name: system})).graph

    assert max(map(len, graph.types)) < 225
    assert set(graph.nodes) == {"pilothouse"}


async def test_a_system_is_activated_by_its_service(native: Offered) -> None:
    asked = {"transition": {"id": 3, "label": "activate"}}

    assert await native.call("/actuation/change_state", asked) == {"success": True}

    state = await native.call("/actuation/get_state", {})
    assert state == {"current_state": {"id": 3, "label": "active"}}


async def test_who_asked_is_on_record(native: Offered) -> None:
    await native.call("/drive_base/change_mode", {"mode_name": "FAST"})

    events = native.robot.supervisor.events.oldest_first()
    assert [e.actor.label for e in events if e.kind == "change.requested"] == ["ros"]


async def test_modes_are_asked_and_told_in_the_types_that_stand_in(carried: Offered) -> None:
    heard: list[Any] = carried.graph.published("/drive_base/mode_event")

    asked = {"transition": {"id": 0, "label": "active.FAST"}}
    assert await carried.call("/drive_base/change_mode", asked) == {"success": True}

    mode = await carried.call("/drive_base/get_mode", {})
    assert mode == {"current_state": {"id": 3, "label": "active.FAST"}}
    assert [event["goal_state"]["label"] for event in heard] == ["active.FAST"]


async def test_states_of_robot_and_task_are_published_together_at_twenty_hertz(
    native: Offered,
) -> None:
    states: list[Any] = native.graph.published("/system_state")
    tasks: list[Any] = native.graph.published("/task_planner_status")
    before = len(states)

    await native.clock.advance(5.0)

    assert len(states) - before == 100
    assert {message["state"] for message in states} == {0}
    assert [m["header"]["stamp"] for m in states] == [m["header"]["stamp"] for m in tasks]


@pytest.mark.parametrize("missing", [(), NOT_BUILT])
async def test_a_file_that_cannot_be_served_is_answered_with_the_reason(
    missing: tuple[str, ...],
) -> None:
    async for offered in run(Offered(missing)):
        field = "load_namespace" if missing else "file"
        response = await offered.call("/serve_waypoints", {field: "loop.csv"})

        assert not response["success"]
        assert response["message"].startswith("this robot has no folder for waypoint files")


async def test_the_overlay_is_made_only_while_somebody_subscribes(native: Offered) -> None:
    overlays = native.graph.published("/pilothouse/overlay")
    await native.clock.advance(5.0)
    assert not overlays

    native.graph.hear("/pilothouse/overlay")
    await native.clock.advance(5.0)
    native.graph.leave("/pilothouse/overlay")
    await native.clock.advance(0.6)
    seen = len(overlays)
    await native.clock.advance(5.0)

    assert seen == len(overlays) >= 5


async def test_a_reading_is_heard_and_a_refused_one_is_logged(
    native: Offered, caplog: pytest.LogCaptureFixture
) -> None:
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}

    native.graph.publish("/battery_level", {"header": header, "battery_level": 7.0})
    native.graph.publish("/battery_level", {"header": header, "battery_level": 0.25})

    view = native.robot.supervisor.core.signal("battery_level")
    assert (view.value, view.source) == (0.25, "ros")
    (record,) = caplog.records
    assert "rejected a reading of ros: battery_level" in record.getMessage()


async def test_rejected_messages_are_counted(native: Offered) -> None:
    for level in (7.0, 8.0, 0.5, 7.0):
        native.graph.publish("/battery_level", {"battery_level": level})

    assert native.robot.supervisor.refused_readings.counts == {"ros": 3}


def test_a_topic_that_the_robot_file_maps_is_not_heard_twice() -> None:
    types = Offered(mapped=("/estop",)).graph.types

    assert "/estop" not in types
    assert "/battery_level" in types
