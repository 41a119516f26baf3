"""The block `devices`, as somebody writes it into a robot file."""

import pytest

from domain.devices.settings import NOTHING_OFFLINE, DeviceSettings
from domain.errors import InvalidValueError
from domain.lifecycle import LifecycleState
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import seconds
from service.files.model_file import read_model
from service.files.robot_file import RobotSettings, read_robot_file, robot_settings_of
from tests.support.models import ARM, BASE, actuation_model

MODEL = actuation_model()

SYSTEMS = """
carrier: {ros__parameters: {type: system, parts: [base, arm],
          modes: {__DEFAULT__: {base: active, arm: active}}}}
base: {ros__parameters: {type: system, parts: [left, right],
       modes: {__DEFAULT__: {left: active, right: active}, FULL: {lift: active}}}}
left: {ros__parameters: {type: node}}
right: {ros__parameters: {type: node}}
lift: {ros__parameters: {type: node}}
arm: {ros__parameters: {type: node}}
"""


def settings_of(text: str, model: SmhModel = MODEL) -> dict[str, DeviceSettings]:
    read = read_robot_file(text, model)
    return {device.name: device for device in read.to_device_settings(model)}


def test_a_robot_of_one_computer_has_no_devices() -> None:
    assert RobotSettings().to_device_settings(MODEL) == ()


def test_a_device_owns_the_nodes_that_it_names() -> None:
    devices = settings_of("devices: {base: {parts: [/drive_base]}, arm: {parts: [manipulator]}}")

    assert devices["base"].nodes == (BASE,)
    assert devices["arm"].nodes == (ARM,)
    assert devices["arm"].offline == NOTHING_OFFLINE


def test_a_system_stands_for_all_nodes_below_it() -> None:
    devices = settings_of("devices: {chassis: {parts: [base]}}", read_model(SYSTEMS).model)

    assert devices["chassis"].nodes == ("left", "right")


def test_nodes_are_in_the_order_of_the_model() -> None:
    (device,) = settings_of("devices: {all: {parts: [manipulator, actuation]}}").values()

    assert device.nodes == (BASE, ARM)


def test_a_device_reads_its_signals_and_those_of_its_parts() -> None:
    devices = settings_of(
        "signals: {motor: {part: drive_base}, arm_load: {part: manipulator},"
        " motor_mean: {of: motor, statistic: mean, window_s: 5, part: drive_base}}\n"
        "devices: {base: {parts: [drive_base], signals: [/battery_level, motor]}}"
    )

    assert devices["base"].signals == ("battery_level", "motor")


def test_the_signals_of_a_system_go_with_all_of_its_nodes() -> None:
    text = "signals: {load: {part: actuation}}\ndevices: {one: {parts: [%s]}}"

    assert settings_of(text % "actuation")["one"].signals == ("load",)
    assert settings_of(text % "drive_base")["one"].signals == ()


def test_what_a_device_does_when_cut_off_is_read() -> None:
    (device,) = settings_of(
        "devices: {base: {parts: [drive_base],"
        " offline: {after_s: 3, target: {/drive_base: active.SLOW}, reactions: true}}}"
    ).values()

    assert device.offline.after == seconds(3)
    assert device.offline.targets == {BASE: StateAndMode.parse("active.SLOW")}
    assert device.offline.reactions


def test_a_part_that_only_some_modes_name_must_be_its_own_as_well() -> None:
    model = read_model(SYSTEMS).model
    text = "devices: {{all: {{parts: [base, {}], offline: {{target: {{base: inactive}}}}}}}}"

    (device,) = settings_of(text.format("lift"), model).values()

    assert device.offline.targets == {PartName("base"): StateAndMode(LifecycleState.INACTIVE)}


def test_two_files_that_mean_the_same_have_the_same_owners() -> None:
    one = read_robot_file("devices: {a: {parts: [drive_base]}, b: {parts: [manipulator]}}", MODEL)
    other = read_robot_file(
        "devices:\n  b: {parts: [/manipulator]}\n  a: {parts: [drive_base], signals: []}\n", MODEL
    )

    assert one.ownership_text(MODEL) == other.ownership_text(MODEL)


def test_a_simulation_is_one_computer_whatever_the_robot_has() -> None:
    robot = robot_settings_of({"devices": {"base": {"parts": ["drive_base"]}}}, MODEL)

    assert robot.to_device_settings(MODEL) == ()


def test_a_simulation_checks_the_devices_all_the_same() -> None:
    with pytest.raises(InvalidValueError) as caught:
        robot_settings_of({"devices": {"base": {"parts": ["drive_bas"]}}}, MODEL)

    assert caught.value.pointer == "/devices/base/parts/0"
