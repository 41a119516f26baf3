"""The example robot with its ROS interface, live, on a clock that a test moves."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from domain.actor import Actor
from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault
from domain.state_and_mode import PartName
from service.ros.interface.endpoints import Fields
from service.ros.interface.interface import RosInterface
from service.ros.interface.settings import USUAL_SETTINGS, InterfaceSettings
from tests.support.live_robot import make_live_robot, running
from tests.support.manual_clock import ManualClock, settle

OPERATOR = Actor("test:operator")


class RosRobot:
    """The example robot, its ROS interface, and what was heard of it."""

    def __init__(
        self, model: SmhModel | None = None, settings: InterfaceSettings = USUAL_SETTINGS
    ) -> None:
        self.clock = ManualClock()
        self.supervisor, self.backend = make_live_robot(self.clock, model)
        self.interface = RosInterface(self.supervisor, settings)

    def hear(self, topic: str) -> list[Any]:
        """Listen to a topic; what is returned grows with each message."""
        heard: list[Any] = []
        self.interface.listen(topic, heard.append)
        return heard

    async def call(self, service: str, request: Fields | None = None) -> Fields:
        """Call a service, and let a minute pass at most until there is a response."""
        offered = self.interface.services[service]
        asked = asyncio.ensure_future(offered.call(request or {}, OPERATOR))
        await settle()
        for _ in range(610):
            if asked.done():
                break
            await self.clock.advance(0.1)
        return await asked

    async def change_mode(self, part: str, mode: str) -> None:
        """Bring a part into a mode."""
        assert await self.call(f"/{part}/change_mode", {"mode_name": mode}) == {"success": True}

    def fault(self, node: str, fault: Fault) -> None:
        """Let something be wrong with a node."""
        self.backend.set_fault(PartName(node), fault)


@asynccontextmanager
async def running_ros_robot(
    model: SmhModel | None = None, settings: InterfaceSettings = USUAL_SETTINGS
) -> AsyncIterator[RosRobot]:
    """Let a robot and its interface run as long as the context lasts."""
    robot = RosRobot(model, settings)
    async with running(robot.supervisor), running_interface(robot.interface):
        yield robot


@asynccontextmanager
async def running_interface(interface: RosInterface) -> AsyncIterator[None]:
    """Let an interface run as long as the context lasts."""
    run = asyncio.create_task(interface.run(), name="ROS interface")
    try:
        await settle()
        yield
    finally:
        run.cancel()
        await asyncio.gather(run, return_exceptions=True)
