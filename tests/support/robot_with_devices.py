"""The example robot with its nodes on two devices, and a link on which tests say what is heard."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field

from domain.commands import LinkCommand
from domain.computers import ComputerName, Connection, DeviceState, Incarnation, Session
from domain.devices.settings import DeviceSettings, OfflineSettings
from domain.inputs import DeviceStatus, Input
from domain.state_and_mode import StateAndMode
from domain.supervision import SupervisionSettings
from domain.timebase import Instant, seconds
from service.ports import Deliver
from tests.support.http_robot import HttpRobot, http_robot
from tests.support.models import ARM, BASE

ARM_COMPUTER, BASE_COMPUTER = ComputerName("arm"), ComputerName("base")
DEVICES = {
    BASE_COMPUTER: DeviceSettings(
        BASE_COMPUTER,
        (BASE,),
        offline=OfflineSettings(seconds(2), {BASE: StateAndMode.parse("inactive")}, reactions=True),
    ),
    ARM_COMPUTER: DeviceSettings(ARM_COMPUTER, (ARM,)),
}
SETTINGS = SupervisionSettings(devices=DEVICES)


@dataclass
class ToldLink:
    """A link that carries nothing; how its connections are is as a test says."""

    connections: dict[ComputerName, Connection] = field(default_factory=dict)

    def connection(self, computer: ComputerName, /) -> Connection:
        return self.connections.get(computer, Connection())

    def send(self, command: LinkCommand, /) -> None:
        """Tell nobody."""

    def note(self, given: Input, /) -> None:
        """Tell nobody."""

    async def run(self, deliver: Deliver) -> None:
        """Do nothing: the link of a test is set once its robot runs."""


@asynccontextmanager
async def device_robot() -> AsyncIterator[tuple[HttpRobot, ToldLink]]:
    """Let the example robot run with a device for each of its nodes; none is heard yet."""
    async with http_robot(settings=SETTINGS) as robot:
        link = robot.supervisor.link = ToldLink()
        yield robot, link


def status(
    device: ComputerName, state: DeviceState = DeviceState.CONNECTED, reason: str = ""
) -> DeviceStatus:
    """Return how a device is reported."""
    return DeviceStatus(
        device,
        state,
        reason,
        Incarnation("1" * 32),
        Session("2" * 32) if state is DeviceState.CONNECTED else None,
        "0.1.0",
    )


def heard(at: Instant) -> Connection:
    """Return a good connection."""
    return Connection(heard_at=at, round_trip=seconds(0.1), lost_share=0.02, dropped=3)
