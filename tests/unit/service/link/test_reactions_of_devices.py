"""A reaction that a device decides about, on a robot of two computers in virtual time."""

from collections.abc import AsyncIterator

import pytest

from domain.computers import SUPERVISOR, ComputerName
from domain.inputs import ErrorReport, ModeRequest
from domain.state_and_mode import ModeName
from service.files.model_file import read_model
from service.link.memory import MemoryNetwork
from service.supervisor import Supervisor
from tests.support.linked_robot import Running, make_computer, settings_of
from tests.support.manual_clock import ManualClock
from tests.support.models import BASE, active

MODEL = read_model("""
drive_base: {ros__parameters: {type: node,
  modes: {__DEFAULT__: {ros__parameters: {max_speed: 0.1}},
          SLOW: {ros__parameters: {max_speed: 0.2}}, FAST: {ros__parameters: {max_speed: 0.9}}},
  errors: {WARM: {}},
  reactions: {CALM: {when: "drive_base.errors.WARM", action: mode, target: active.SLOW}}}}
""").model
DEVICES = {
    "base": {"parts": ["drive_base"], "offline": {"target": {"drive_base": "inactive"}}},
}
NAMES = (SUPERVISOR, ComputerName("base"))


class Robot:
    """A supervisor and the device that owns the drive base, which is fast."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.network = MemoryNetwork(NAMES, self.clock)
        self.running = Running()
        self.services: dict[str, Supervisor] = {}
        for name in NAMES:
            link, robot = self.network.link(name), settings_of(name, DEVICES)
            self.services[name], _ = make_computer(MODEL, robot, link, self.clock)
            self.running.start(name, self.services[name])

    async def find_warm(self, *, active: bool = True) -> None:
        """Let somebody report at the device that the drive is warm, or no longer."""
        self.services["base"].submit(ErrorReport(BASE, "WARM", active))
        await self.clock.advance(2.0)

    @property
    def seen(self) -> tuple[str, str]:
        """Return the target in force and the actual, as the supervisor sees them."""
        part = self.services[SUPERVISOR].core.part(BASE)
        pursued = part.effective_target
        assert pursued is not None
        return (
            f"{pursued.mode} by {pursued.because}",
            part.actual.state_and_mode.label,
        )


@pytest.fixture
async def robot() -> AsyncIterator[Robot]:
    robot = Robot()
    await robot.clock.advance(3.0)
    robot.services[SUPERVISOR].submit(ModeRequest(BASE, ModeName("FAST")))
    await robot.clock.advance(5.0)
    assert robot.seen == ("FAST by requested", "active.FAST")
    yield robot
    await robot.running.stop()


async def test_the_device_acts_and_the_supervisor_shows_it_and_leads_back(robot: Robot) -> None:
    await robot.find_warm()
    assert robot.seen == ("SLOW by local", "active.SLOW")

    await robot.find_warm(active=False)
    assert robot.seen == ("FAST by requested", "active.FAST")


async def test_the_device_acts_alone_and_what_is_stays_when_it_is_back(robot: Robot) -> None:
    robot.network.set_cut(*NAMES, is_cut=True)
    await robot.clock.advance(5.0)
    assert not robot.services[SUPERVISOR].core.part(BASE).reachable
    at_the_device = robot.services["base"].core.part(BASE)
    assert at_the_device.actual.state_and_mode.label == "inactive"

    robot.network.set_cut(*NAMES, is_cut=False)
    await robot.clock.advance(5.0)

    assert robot.seen == ("FAST by requested", "inactive")
    assert robot.services["base"].core.part(BASE).target is None


async def test_after_the_cut_the_supervisor_brings_it_where_somebody_asks(robot: Robot) -> None:
    robot.network.set_cut(*NAMES, is_cut=True)
    await robot.clock.advance(5.0)
    robot.network.set_cut(*NAMES, is_cut=False)
    await robot.clock.advance(5.0)

    robot.services[SUPERVISOR].submit(ModeRequest(BASE, ModeName("FAST")))
    await robot.clock.advance(5.0)

    assert robot.services[SUPERVISOR].core.part(BASE).actual.state_and_mode == active("FAST")
