"""The worked example of D4.8 (Annex 4, 6.2.2) with real nodes: every one a process of its own."""

from collections.abc import AsyncIterator, Iterator
from contextlib import ExitStack
from typing import Any

import pytest

from service.ros.graph.graph import Client, Lane, RosNode
from tests.ros2.support.service import POLL_S, RosRobot, node, ros_robot
from tests.support.waiting import until

pytestmark = pytest.mark.ros2

LIFECYCLE = "lifecycle_msgs/srv"


@pytest.fixture
def nodes() -> Iterator[None]:
    with ExitStack() as running:
        for name in ("drive_base", "manipulator"):
            running.enter_context(node(name))
        yield


@pytest.fixture
async def robot(nodes: None) -> AsyncIterator[RosRobot]:
    async with ros_robot() as robot:
        await robot.until_reachable("drive_base", "manipulator")
        yield robot


class Operator:
    """Somebody with ROS 2 only, in which a mode is asked for as a state of ROS 2."""

    def __init__(self, ros: RosNode) -> None:
        self._ros = ros
        self._clients: dict[str, Client] = {}

    async def change_state(self, part: str, transition: str) -> bool:
        wanted = {"transition": {"label": transition}}
        return bool((await self._call(part, "change_state", "ChangeState", wanted)).success)

    async def change_mode(self, part: str, mode: str) -> bool:
        wanted = {"transition": {"label": mode}}
        return bool((await self._call(part, "change_mode", "ChangeState", wanted)).success)

    async def shown(self, part: str) -> tuple[int, str, str]:
        """Return number and label of the state, and the label of the mode."""
        state = (await self._call(part, "get_state", "GetState")).current_state
        mode = (await self._call(part, "get_mode", "GetState")).current_state
        return state.id, state.label, mode.label

    async def _call(
        self, part: str, service: str, kind: str, request: dict[str, Any] | None = None
    ) -> Any:  # noqa: ANN401
        name = f"/{part}/{service}"
        if name not in self._clients:
            self._clients[name] = self._ros.client(name, f"{LIFECYCLE}/{kind}")
        await until(self._clients[name].is_ready, POLL_S)
        return await self._clients[name].call(request or {}, 30)


@pytest.fixture
async def operator() -> AsyncIterator[Operator]:
    from service.ros.graph.link import RosLink

    link = RosLink()
    yield Operator(link.node("operator", Lane.GATEWAY))
    await link.close()


async def test_the_four_steps_over_http(robot: RosRobot) -> None:
    await robot.do("/systems/actuation/state", transition="configure")
    assert await robot.actual() == {
        "actuation": ("inactive", None),
        "drive_base": ("inactive", None),
        "manipulator": ("inactive", None),
    }

    await robot.do("/systems/actuation/state", transition="activate")
    assert await robot.actual() == {
        "actuation": ("active", "__DEFAULT__"),
        "drive_base": ("active", "__DEFAULT__"),
        "manipulator": ("inactive", None),
    }

    await robot.do("/systems/actuation/mode", mode="PERFORMANCE")
    assert await robot.actual() == {
        "actuation": ("active", "PERFORMANCE"),
        "drive_base": ("active", "FAST"),
        "manipulator": ("active", "STRONG"),
    }

    await robot.do("/nodes/drive_base/mode", mode="SLOW")
    await robot.do("/nodes/manipulator/mode", mode="WEAK")
    assert await robot.actual() == {
        "actuation": ("activating", "MODERATE"),
        "drive_base": ("active", "SLOW"),
        "manipulator": ("active", "WEAK"),
    }
    assert await robot.targets() == {
        "actuation": ("active", "PERFORMANCE"),
        "drive_base": ("active", "SLOW"),
        "manipulator": ("active", "WEAK"),
    }


async def test_the_four_steps_through_ros(robot: RosRobot, operator: Operator) -> None:
    assert await operator.change_state("actuation", "configure")
    assert await operator.shown("actuation") == (2, "inactive", "")
    assert await operator.shown("drive_base") == (2, "inactive", "")
    assert await operator.shown("manipulator") == (2, "inactive", "")

    assert await operator.change_state("actuation", "activate")
    assert await operator.shown("actuation") == (3, "active", "active.__DEFAULT__")
    assert await operator.shown("drive_base") == (3, "active", "active.__DEFAULT__")
    assert await operator.shown("manipulator") == (2, "inactive", "")

    assert await operator.change_mode("actuation", "PERFORMANCE")
    assert await operator.shown("actuation") == (3, "active", "active.PERFORMANCE")
    assert await operator.shown("drive_base") == (3, "active", "active.FAST")
    assert await operator.shown("manipulator") == (3, "active", "active.STRONG")

    assert await operator.change_mode("drive_base", "SLOW")
    assert await operator.change_mode("manipulator", "active.WEAK")
    assert await operator.shown("actuation") == (13, "activating", "active.MODERATE")
    assert await operator.shown("drive_base") == (3, "active", "active.SLOW")
    assert await operator.shown("manipulator") == (3, "active", "active.WEAK")


async def test_what_there_is_not_is_refused_through_ros(
    robot: RosRobot, operator: Operator
) -> None:
    assert not await operator.change_state("actuation", "fly")
    assert not await operator.change_mode("actuation", "FLYING")

    assert await operator.shown("actuation") == (1, "unconfigured", "")
    assert (await robot.get("/changes"))["items"] == []


async def test_a_transition_by_somebody_else_is_seen(robot: RosRobot, operator: Operator) -> None:
    assert await operator.change_state("drive_base", "configure")

    await robot.until_state("drive_base", "inactive")
    assert (await robot.get("/changes"))["items"] == []
