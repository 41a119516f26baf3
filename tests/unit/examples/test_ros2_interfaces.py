"""The messages that are shipped as source; those of the modes are those of system_modes."""

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
    "pilothouse_msgs/msg/BatteryLevel.msg": [HEADER, "float32 battery_level"],
    "pilothouse_msgs/msg/EmergencyStop.msg": [HEADER, "bool enabled"],
    "pilothouse_msgs/msg/GpsAccuracy.msg": [HEADER, "float32 accuracy"],
    "pilothouse_msgs/msg/SignalStrength.msg": [
        "uint8 NOT_CONNECTED=0",
        "uint8 CONNECTED=1",
        "uint8 LOW_SIGNAL=2",
        HEADER,
        "uint8 strength",
    ],
    "pilothouse_msgs/msg/SystemState.msg": [
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
    "pilothouse_msgs/msg/TaskStatus.msg": [
        "uint8 STATUS_NO_TASK=0",
        "uint8 STATUS_PAUSED_TASK=1",
        "uint8 STATUS_RUNNING_TASK=2",
        HEADER,
        "uint8 status",
    ],
    "pilothouse_msgs/msg/Temperature.msg": [HEADER, "float32 temperature"],
    "pilothouse_msgs/msg/Waypoint.msg": ["float64 x_m", "float64 y_m", "float64 yaw_rad"],
    "pilothouse_msgs/srv/StartTask.srv": [
        "string file",
        "uint64 start_index",
        "string controller",
        "float64 speed_mps",
        "---",
        "bool success",
        "string message",
        "string task",
    ],
    "pilothouse_msgs/srv/DriveWaypoints.srv": [
        "Waypoint[] waypoints",
        "uint64 start_index",
        "string controller",
        "float64 speed_mps",
        "---",
        "bool success",
        "string message",
        "string task",
    ],
    "pilothouse_msgs/action/NavigateWaypoints.action": [
        "Waypoint[] waypoints",
        "uint64 start_index",
        "float64 speed_mps",
        "---",
        "bool success",
        "string message",
        "---",
        "uint64 target_index",
        "float32 progress",
    ],
}
"""By file, in order. Another order of the fields would be another type: a peer that was built from
the original, or from an earlier release, would not be understood."""


def declared(text: str) -> list[str]:
    """Return what a file declares, without comments and empty lines."""
    lines = (line.partition("#")[0].strip() for line in text.splitlines())
    return [line for line in lines if line]


@pytest.mark.parametrize("name", DECLARED)
def test_fields_and_constants_stay_as_peers_know_them(name: str) -> None:
    assert declared((FOLDER / name).read_text(encoding="utf-8")) == DECLARED[name]


@pytest.mark.parametrize("package", ["pilothouse_msgs", "system_modes_msgs"])
def test_every_interface_of_a_package_is_generated(package: str) -> None:
    there = [name for name in DECLARED if name.startswith(package)]
    text = (FOLDER / package / "CMakeLists.txt").read_text(encoding="utf-8")

    generated = re.findall(r'"((?:msg|srv|action)/\w+\.\w+)"', text)

    assert sorted(f"{package}/{name}" for name in generated) == sorted(there)
    found = (FOLDER / package).glob("*/*")
    assert sorted(str(path.relative_to(FOLDER)) for path in found) == sorted(there)
