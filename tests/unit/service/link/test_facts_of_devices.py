"""What a device says of its motor, and what somebody says of it at the supervisor, in one story."""

import logging
from collections.abc import AsyncIterator

import pytest

from domain.computers import SUPERVISOR, ComputerName
from domain.errors import ActsElsewhereError
from domain.inputs import ErrorReport, Reading, Readings
from domain.snapshot import ErrorKey
from service.files.model_file import read_model
from service.link.memory import MemoryNetwork
from service.supervisor import Supervisor
from tests.support.linked_robot import Running, make_computer, settings_of
from tests.support.manual_clock import ManualClock
from tests.support.models import BASE

MODEL = read_model("""
drive_base: {ros__parameters: {type: node, errors: {SLIPS: {}}}}
""").model
DEVICES = {"base": {"parts": ["drive_base"], "signals": ["estop"]}}
NAMES = (SUPERVISOR, ComputerName("base"))
MOTOR = "motor_temperature"
MOTOR_HOT, SLIPS = ErrorKey(BASE, "MOTOR_HOT"), ErrorKey(BASE, "SLIPS")
SIGNALS = {MOTOR: {"part": BASE, "above": 90.0, "error": "MOTOR_HOT", "stale_after_s": 0.0}}


class Robot:
    """A supervisor and the device that reads the motor and the emergency stop button."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.network = MemoryNetwork(NAMES, self.clock)
        self.running = Running()
        self.services: dict[str, Supervisor] = {}
        for name in NAMES:
            link, robot = self.network.link(name), settings_of(name, DEVICES, signals=SIGNALS)
            self.services[name], _ = make_computer(MODEL, robot, link, self.clock)
            self.running.start(name, self.services[name])

    @property
    def supervisor(self) -> Supervisor:
        return self.services[SUPERVISOR]

    async def post(self, at: str, signal: str, value: float | bool) -> None:
        """Post a reading at a computer, and let the others hear of it."""
        try:
            self.services[at].readings.submit([Reading(signal, value)])
        finally:
            await self.clock.advance(0.1)

    async def report(self, at: str, *, active: bool) -> None:
        """Report at a computer that the drive slips, or no longer."""
        try:
            self.services[at].submit(ErrorReport(BASE, "SLIPS", active))
        finally:
            await self.clock.advance(0.1)

    def shows(self, error: ErrorKey) -> bool:
        """Tell whether the supervisor shows an error."""
        return self.supervisor.core.error(error).state.is_on


@pytest.fixture
async def robot() -> AsyncIterator[Robot]:
    robot = Robot()
    await robot.clock.advance(3.0)
    yield robot
    await robot.running.stop()


async def test_a_hot_motor_stays_hot_whatever_is_posted_at_the_supervisor(robot: Robot) -> None:
    await robot.post("base", MOTOR, 95.0)
    assert robot.shows(MOTOR_HOT)

    with pytest.raises(ActsElsewhereError, match=f"{MOTOR} is read on device base"):
        await robot.post(SUPERVISOR, MOTOR, 10.0)
    await robot.clock.advance(5.0)

    assert robot.supervisor.core.signal(MOTOR).value == 95.0
    assert robot.shows(MOTOR_HOT)


async def test_the_motor_cools_down_once_its_device_says_so(robot: Robot) -> None:
    await robot.post("base", MOTOR, 95.0)
    await robot.post("base", MOTOR, 60.0)

    assert robot.supervisor.core.signal(MOTOR).value == 60.0
    assert not robot.shows(MOTOR_HOT)


async def test_nobody_speaks_for_a_device_that_is_lost(robot: Robot) -> None:
    await robot.post("base", MOTOR, 95.0)
    robot.network.set_cut(*NAMES, is_cut=True)
    await robot.clock.advance(5.0)

    with pytest.raises(ActsElsewhereError):
        await robot.post(SUPERVISOR, MOTOR, 10.0)

    assert robot.shows(MOTOR_HOT)


async def test_what_the_supervisor_hears_by_itself_of_a_motor_elsewhere_is_logged_alone(
    robot: Robot, caplog: pytest.LogCaptureFixture
) -> None:
    await robot.post("base", MOTOR, 95.0)

    with caplog.at_level(logging.WARNING):
        robot.supervisor.deliver_of_here(Readings((Reading(MOTOR, 10.0),), "ros:/motor"))
        robot.supervisor.deliver_of_here(ErrorReport(BASE, "SLIPS", active=True))

    assert robot.shows(MOTOR_HOT)
    assert not robot.shows(SLIPS)
    assert robot.supervisor.refused_readings.counts == {"ros": 1}
    assert f"{MOTOR} is read on device base" in caplog.text
    assert "drive_base.SLIPS is reported on device base" in caplog.text


async def test_a_stop_that_is_asked_for_is_taken_wherever_the_button_is_read(robot: Robot) -> None:
    await robot.post(SUPERVISOR, "estop", True)
    assert robot.shows(ErrorKey(None, "ESTOP"))

    with pytest.raises(ActsElsewhereError, match="estop is read on device base"):
        await robot.post(SUPERVISOR, "estop", False)
    assert robot.shows(ErrorKey(None, "ESTOP"))

    await robot.post("base", "estop", False)
    assert not robot.shows(ErrorKey(None, "ESTOP"))


async def test_an_error_of_a_device_is_over_when_it_is_reported_there(robot: Robot) -> None:
    await robot.report("base", active=True)
    assert robot.shows(SLIPS)

    with pytest.raises(ActsElsewhereError, match=r"drive_base\.SLIPS is reported on device base"):
        await robot.report(SUPERVISOR, active=False)
    await robot.clock.advance(5.0)
    assert robot.shows(SLIPS)

    await robot.report("base", active=False)
    assert not robot.shows(SLIPS)
