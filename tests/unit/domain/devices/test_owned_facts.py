"""What only a device may say, and what anybody may."""

import pytest

from domain.computers import ComputerName
from domain.devices.owned_facts import is_own
from domain.devices.settings import DeviceSettings
from domain.errors import ActsElsewhereError
from domain.inputs import ErrorReport, Input, NodeReport, Reading, Readings
from domain.state_and_mode import PartName
from domain.supervision import Supervision, SupervisionSettings
from service.files.model_file import read_model

MODEL = read_model("""
robot: {ros__parameters: {type: system, modes: {__DEFAULT__: {cart: active, lidar: active}},
  errors: {LOST: {}}}}
cart: {ros__parameters: {type: system, modes: {__DEFAULT__: {left: active, right: active}},
  errors: {BENT: {}}}}
left: {ros__parameters: {type: node,
  errors: {SLIPS: {}, SILENT: {when: "not left.reachable"}, STUCK: {caused_by: [left.SLIPS]}}}}
right: {ros__parameters: {type: node}}
lidar: {ros__parameters: {type: node, errors: {DIRTY: {}}}}
""").model
BASE = ComputerName("base")
NODES = (PartName("left"), PartName("right"))
DEVICES = {BASE: DeviceSettings(BASE, NODES, ("temperature", "estop"))}


@pytest.fixture
def core() -> Supervision:
    return Supervision(MODEL, SupervisionSettings(devices=DEVICES), 0)


def readings(**values: float | bool | str) -> Readings:
    return Readings(tuple(Reading(name, value) for name, value in values.items()), "api")


def report(part: str | None, error: str) -> ErrorReport:
    return ErrorReport(None if part is None else PartName(part), error, active=False)


@pytest.mark.parametrize(
    ("given", "message", "hint"),
    [
        (
            readings(temperature=20.0),
            "temperature is read on device base, whatever is said here",
            "post it at base",
        ),
        (
            readings(battery_level=0.5, temperature=20.0),
            "temperature is read on device base, whatever is said here",
            "post it at base",
        ),
        (
            readings(estop=False),
            "estop is read on device base, whatever is said here",
            "post it at base",
        ),
        (
            report("left", "SLIPS"),
            "left.SLIPS is reported on device base, whatever is said here",
            "report it at base",
        ),
        (
            report("cart", "BENT"),
            "cart.BENT is reported on device base, whatever is said here",
            "report it at base",
        ),
    ],
)
def test_who_speaks_for_a_device_is_sent_there(
    given: Input, message: str, hint: str, core: Supervision
) -> None:
    with pytest.raises(ActsElsewhereError) as refused:
        core.check_said_here(given)

    assert (refused.value.message, refused.value.hint) == (message, hint)


@pytest.mark.parametrize(
    "given",
    [
        readings(battery_level=0.5),
        readings(estop=True),
        readings(estop=1),
        readings(estop="yes"),
        report("lidar", "DIRTY"),
        report("robot", "LOST"),
        NodeReport(PartName("left"), reachable=True),
    ],
)
def test_what_is_no_devices_own_is_said_anywhere(given: Input, core: Supervision) -> None:
    core.check_said_here(given)


@pytest.mark.parametrize(
    "given",
    [
        report("left", "SILENT"),
        report("left", "STUCK"),
        report("left", "TYPO"),
        report("nobody", "SLIPS"),
        report(None, "ESTOP"),
    ],
)
def test_what_nobody_can_report_is_left_to_whoever_says_why(
    given: Input, core: Supervision
) -> None:
    core.check_said_here(given)


def test_on_a_robot_of_one_computer_everything_is_said_here() -> None:
    core = Supervision(MODEL, SupervisionSettings(), 0)

    core.check_said_here(readings(temperature=20.0, estop=False))
    core.check_said_here(report("left", "SLIPS"))


def test_what_the_device_itself_says_is_taken(core: Supervision) -> None:
    core.handle(readings(temperature=20.0, estop=False), 1)

    assert core.signal("temperature").value == 20.0


@pytest.mark.parametrize(
    ("part", "is_of_base"), [("left", True), ("cart", True), ("lidar", False), ("robot", False)]
)
def test_a_system_is_a_devices_own_if_all_below_it_is(part: str, is_of_base: bool) -> None:
    assert is_own(PartName(part), NODES, MODEL) is is_of_base
