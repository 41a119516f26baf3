"""The messages that are shipped as source are those of system_modes and smart_polaris."""

import re

import pytest

from tests.support.shared import PROJECT

FOLDER = PROJECT / "examples" / "ros2" / "interfaces"
HEADER = "std_msgs/Header header"
DECLARED = {
    "system_modes_msgs/msg/Mode.msg": ["string label"],
    "system_modes_msgs/msg/ModeEvent.msg": [
        "uint64 timestamp",
        "Mode start_mode",
        "Mode goal_mode",
    ],
    "system_modes_msgs/srv/ChangeMode.srv": ["string mode_name", "---", "bool success"],
    "system_modes_msgs/srv/GetMode.srv": ["---", "string current_mode"],
    "system_modes_msgs/srv/GetAvailableModes.srv": ["---", "string[] available_modes"],
    "gem_state_msgs/msg/BatteryLevelStamped.msg": [HEADER, "float32 battery_level"],
    "gem_state_msgs/msg/EstopStamped.msg": [HEADER, "bool enabled"],
    "gem_state_msgs/msg/GpsAccuracyStamped.msg": [HEADER, "float32 accuracy"],
    "gem_state_msgs/msg/SignalStrengthStamped.msg": [
        "uint8 NOT_CONNECTED=0",
        "uint8 CONNECTED=1",
        "uint8 LOW_SIGNAL=2",
        HEADER,
        "uint8 strength",
    ],
    "gem_state_msgs/msg/SystemStateStamped.msg": [
        "uint8 ERROR_NONE=0",
        "uint8 ERROR_BATTERY_LOW=1",
        "uint8 ERROR_ESTOP=2",
        "uint8 ERROR_GPS_LOST=4",
        "uint8 ERROR_SIGNAL_LOST=8",
        "uint8 ERROR_SIGNAL_LOW=16",
        "uint8 ERROR_TEMPERATURE_HIGH=32",
        "uint8 ERROR_STALE_DATA=64",
        "uint8 STATE_IDLE=0",
        "uint8 STATE_RUNNING=1",
        "uint8 STATE_ERROR=2",
        HEADER,
        "uint8 error_code",
        "uint8 state",
    ],
    "gem_state_msgs/msg/TaskPlannerStatus.msg": [
        "uint8 STATUS_NO_TASK=0",
        "uint8 STATUS_PAUSED_TASK=1",
        "uint8 STATUS_RUNNING_TASK=2",
        HEADER,
        "uint8 status",
    ],
    "gem_state_msgs/msg/TemperatureStamped.msg": [HEADER, "float32 temperature"],
}
"""By file, in order. Another order of the fields would be another type: a peer that was built from
the originals would not be understood."""


def declared(text: str) -> list[str]:
    """Return what a file declares, without comments and empty lines."""
    lines = (line.partition("#")[0].strip() for line in text.splitlines())
    return [line for line in lines if line]


@pytest.mark.parametrize("name", DECLARED)
def test_fields_and_constants_are_those_of_the_original(name: str) -> None:
    assert declared((FOLDER / name).read_text(encoding="utf-8")) == DECLARED[name]


@pytest.mark.parametrize("package", ["gem_state_msgs", "system_modes_msgs"])
def test_every_interface_of_a_package_is_generated(package: str) -> None:
    there = [name for name in DECLARED if name.startswith(package)]
    text = (FOLDER / package / "CMakeLists.txt").read_text(encoding="utf-8")

    generated = re.findall(r'"((?:msg|srv)/\w+\.\w+)"', text)

    assert sorted(f"{package}/{name}" for name in generated) == sorted(there)
    found = [*(FOLDER / package).glob("msg/*"), *(FOLDER / package).glob("srv/*")]
    assert sorted(str(path.relative_to(FOLDER)) for path in found) == sorted(there)
