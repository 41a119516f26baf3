"""Pilothouse in a real ROS 2 graph: what tools and clients find there, and what they can do.

The robot behind it is simulated; real nodes are met in `test_annex4.py`. The types of
`system_modes_msgs` and `pilothouse_msgs` are not installed here, see `test_interfaces.py` for them.
"""

import asyncio
import sys
from collections.abc import AsyncIterator
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from api.rosbridge.definitions import MESSAGES
from domain.inputs import Reading, TaskRequest
from domain.simulation.node_settings import Fault
from service.clock import MonotonicClock
from service.ros.gateway import RosGateway
from service.ros.graph.conversion import fields_of
from service.ros.graph.graph import Fields, Lane, Qos, RosNode
from service.ros.interface.interface import RosInterface
from service.simulation.simulated import SimulatedBackend
from service.supervisor import Supervisor
from tests.support.live_robot import make_live_robot, running
from tests.support.models import ARM
from tests.support.paths import straight
from tests.support.waiting import until

pytestmark = pytest.mark.ros2

TOOL = Path(__file__).with_name("support") / "lifecycle_tool.py"
POLL_S = 0.02
WITHIN_S = 20.0
CHANGE_STATE = "lifecycle_msgs/srv/ChangeState"
GET_STATE = "lifecycle_msgs/srv/GetState"


class Robot:
    """The example robot, offered in the graph, and somebody else who is in the graph as well."""

    def __init__(self, supervisor: Supervisor, backend: SimulatedBackend, other: RosNode) -> None:
        self.supervisor = supervisor
        self._backend = backend
        self._other = other

    def hear(self, topic: str, type_name: str, qos: Qos = Qos.EVENTS) -> list[dict[str, Any]]:
        """Listen to a topic; what is returned grows with each message."""
        heard: list[dict[str, Any]] = []
        self._other.subscribe(topic, type_name, qos, fields_of, heard.append)
        return heard

    async def call(self, service: str, type_name: str, request: Fields) -> dict[str, Any]:
        """Call a service once it is found."""
        client = self._other.client(service, type_name)
        await until(client.is_ready, POLL_S)
        return fields_of(await client.call(request, WITHIN_S))

    def writes(self) -> list[object]:
        """Return the audit trail: what was called, and with what status."""
        events = self.supervisor.events.oldest_first()
        trail = [event.data for event in events if event.kind == "audit.write"]
        return [(written["path"], written["status"]) for written in trail]

    def fault(self, fault: Fault) -> None:
        """Let something be wrong with the manipulator."""
        self._backend.set_fault(ARM, fault)


@pytest.fixture
async def robot() -> AsyncIterator[Robot]:
    make_link = import_module("service.ros.graph.link").RosLink
    link, others_link = make_link(), make_link()
    supervisor, backend = make_live_robot(MonotonicClock())
    gateway = RosGateway(RosInterface(supervisor), link, supervisor.clock)
    await gateway.offer()
    async with running(supervisor):
        publishing = asyncio.create_task(gateway.run(), name="gateway")
        yield Robot(supervisor, backend, others_link.node("somebody", Lane.STATES))
        publishing.cancel()
        await asyncio.gather(publishing, return_exceptions=True)
    await others_link.close()
    await link.close()


async def lifecycle(*arguments: str) -> list[str]:
    """Return the lines that `ros2 lifecycle` prints."""
    tool = await asyncio.create_subprocess_exec(
        sys.executable, str(TOOL), *arguments, stdout=asyncio.subprocess.PIPE
    )
    said, _ = await tool.communicate()
    return said.decode().splitlines()


async def test_a_system_is_activated_with_the_tool_for_lifecycle_nodes(robot: Robot) -> None:
    assert await lifecycle("get", "/actuation") == ["unconfigured [1]"]

    assert await lifecycle("set", "/actuation", "activate") == ["Transitioning successful"]

    assert await lifecycle("get", "/actuation") == ["active [3]"]


async def test_the_tool_lists_what_can_be_done_with_a_system(robot: Robot) -> None:
    assert await lifecycle("list", "/actuation") == [
        "- configure [1]",
        "\tStart: unconfigured",
        "\tGoal: inactive",
        "- activate [3]",
        "\tStart: unconfigured",
        "\tGoal: active",
        "- shutdown [5]",
        "\tStart: unconfigured",
        "\tGoal: finalized",
    ]


async def test_the_tool_is_told_what_there_is_instead_of_what_it_asked(robot: Robot) -> None:
    assert await lifecycle("set", "/actuation", "deactivate") == [
        "Unknown transition requested, available ones are:",
        "- configure [1]",
        "- activate [3]",
        "- shutdown [5]",
    ]


async def test_the_tool_is_told_of_a_change_that_fails(robot: Robot) -> None:
    robot.fault(Fault.FAIL)

    assert await lifecycle("set", "/actuation", "configure") == ["Transitioning failed"]


async def test_a_mode_is_asked_read_and_heard_in_types_that_every_installation_has(
    robot: Robot,
) -> None:
    events = robot.hear("/actuation/mode_event", "lifecycle_msgs/msg/TransitionEvent")
    asked = {"transition": {"label": "active.PERFORMANCE"}}

    response = await robot.call("/actuation/change_mode", CHANGE_STATE, asked)
    await until(lambda: len(events) > 0, POLL_S)

    assert response == {"success": True}
    mode = await robot.call("/actuation/get_mode", GET_STATE, {})
    assert mode == {"current_state": {"id": 3, "label": "active.PERFORMANCE"}}
    assert [event["goal_state"]["label"] for event in events] == ["active.PERFORMANCE"]


async def test_a_call_is_in_the_audit_trail_with_its_outcome(robot: Robot) -> None:
    asked = {"transition": {"label": "active.PERFORMANCE"}}
    await robot.call("/actuation/change_mode", CHANGE_STATE, asked)
    await robot.call("/actuation/get_mode", GET_STATE, {})

    assert robot.writes() == [("/actuation/change_mode", 200)]


async def test_who_comes_late_hears_the_last_request(robot: Robot) -> None:
    asked = {"transition": {"label": "FAST"}}
    await robot.call("/drive_base/change_mode", CHANGE_STATE, asked)

    requests = robot.hear(
        "/drive_base/mode_request_info", "lifecycle_msgs/msg/TransitionEvent", Qos.LATCHED
    )
    await until(lambda: len(requests) > 0, POLL_S)

    assert [request["goal_state"]["label"] for request in requests] == ["active.FAST"]


async def test_the_robot_tells_its_state_and_its_diagnostics(robot: Robot) -> None:
    states = robot.hear("/system_state", "diagnostic_msgs/msg/DiagnosticStatus")
    diagnoses = robot.hear("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
    await until(lambda: bool(states and diagnoses), POLL_S)
    assert states[0]["message"] == "IDLE"

    robot.supervisor.readings.submit([Reading("battery_level", 0.2)])
    await until(lambda: states[-1]["level"] == diagnoses[-1]["status"][0]["level"] == 2, POLL_S)

    assert states[-1]["message"] == "ERROR: BATTERY_LOW"
    names = {each["name"] for each in diagnoses[-1]["status"]}
    assert {"pilothouse: system state", "pilothouse: drive_base"} <= names


async def test_who_draws_the_robot_gets_markers_and_the_path_of_its_task(robot: Robot) -> None:
    markers = robot.hear("/pilothouse/overlay", "visualization_msgs/msg/MarkerArray")
    robot.supervisor.submit(TaskRequest(straight(), 0, "pure_pursuit", 1.0))
    await until(lambda: bool(markers and markers[-1]["markers"][0]["points"]), POLL_S)

    assert {each["header"]["frame_id"] for each in markers[-1]["markers"]} == {"map"}

    paths = robot.hear("/pilothouse/path", "nav_msgs/msg/Path", Qos.LATCHED)
    await until(lambda: bool(paths and paths[-1]["poses"]), POLL_S)
    late = robot.hear("/pilothouse/path", "nav_msgs/msg/Path", Qos.LATCHED)
    await until(lambda: len(late) > 0, POLL_S)

    assert late[0] == paths[-1]
    assert [each["pose"]["position"]["x"] for each in late[0]["poses"]] == [0.0, 20.0]


@pytest.mark.parametrize("name", ["Marker", "MarkerArray", "MeshFile", "UVCoordinate"])
def test_viewers_are_told_the_fields_of_a_marker_as_they_are_installed(name: str) -> None:
    installed = getattr(import_module("visualization_msgs.msg"), name)
    lines = [line for line in MESSAGES[f"visualization_msgs/msg/{name}"] if "=" not in line]

    assert [line.partition(" ")[2] for line in lines] == [*installed.get_fields_and_field_types()]
