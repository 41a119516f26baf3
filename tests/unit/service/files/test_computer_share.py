"""What each computer of a robot runs, from one model and one robot file."""

import pytest

from domain.devices.settings import LeadSettings
from domain.errors import UnknownDeviceError
from domain.health.signals import default_signals
from domain.lifecycle import LifecycleState
from domain.state_and_mode import StateAndMode
from domain.timebase import seconds
from service.files.computer_share import ComputerShare, reactions_of_devices, share_of
from service.files.model_file import read_model
from service.files.robot_file import (
    InvalidRobotFileError,
    RobotSettings,
    read_robot_file,
    written_for_device,
)
from service.onboard_parts import make_onboard
from tests.support.models import ARM, BASE, actuation_model

MODEL = actuation_model()
ROBOT = """
include: [cpu]
signals:
  temperature: {source: {file: {path: /tmp/t, period_s: 3}}}
  motor: {part: drive_base, above: 80, error: HOT, source: {file: {path: /tmp/m, period_s: 0.5}}}
  load: {part: manipulator, above: 3, error: OVERLOAD}
nodes:
  drive_base: {on_return: restore, configure_s: 1}
  manipulator: {on_return: restore}
ros2:
  signals: {load: {topic: /load, type: std_msgs/msg/Float64}}
  odometry: {topic: /odom}
start_task: {file: path.csv}
tasks: {folder: tracks}
link: {lost_s: 2}
devices:
  base:
    parts: [drive_base]
    signals: [temperature]
    offline: {after_s: 3, target: {drive_base: inactive}}
"""


def share(device: str | None = None, text: str = ROBOT) -> ComputerShare:
    if device is not None:
        text = written_for_device(text, device)
    return share_of(MODEL, read_robot_file(text, MODEL))


def names(robot: RobotSettings) -> list[str]:
    return [signal.spec.name for signal in robot.to_signal_settings()]


def test_the_only_computer_runs_everything() -> None:
    robot = RobotSettings()

    found = share_of(MODEL, robot)

    assert found == ComputerShare(MODEL, robot, MODEL, robot)
    assert robot.to_lead_settings() is None


# --- a device ------------------------------------------------------------------------------------


def test_a_device_runs_its_own_parts() -> None:
    found = share("base")

    assert found.model.parts == found.local_model.parts == (BASE,)
    assert [*found.robot.nodes] == [BASE]


def test_a_device_reads_its_own_signals() -> None:
    found = share("base")

    assert names(found.robot) == ["estop", "temperature", "motor"]
    assert [*found.robot.signals.sources] == ["temperature", "motor"]
    assert "load" in found.read_elsewhere
    assert "motor" not in found.read_elsewhere


def test_a_device_has_no_vehicle_and_no_task() -> None:
    robot = share("base").robot

    assert robot.start_task is None
    assert robot.tasks is None
    assert robot.ros2.odometry is None


def test_a_device_restores_nothing_by_itself() -> None:
    assert share("base").robot.to_change_settings().restored_nodes == set()
    assert share("base").robot.nodes["drive_base"].configure_s == 1


def test_a_device_knows_what_it_does_when_cut_off() -> None:
    lead = share("base").robot.to_lead_settings()

    assert lead is not None
    assert isinstance(lead, LeadSettings)
    assert (lead.device, lead.lost, lead.offline.after) == ("base", seconds(2), seconds(3))
    assert lead.offline.targets == {BASE: StateAndMode(LifecycleState.INACTIVE)}


def test_a_device_tells_what_it_leaves_out() -> None:
    text = "devices: {arm: {parts: [manipulator]}}"

    assert share("arm", text).left_out == ()


def test_the_core_of_a_device_is_made_from_what_its_record_keeps() -> None:
    robot = read_robot_file(written_for_device(ROBOT, "base"), MODEL)

    core = make_onboard(MODEL, robot, 0).core

    assert core.model.parts == (BASE,)
    assert [*core.signals()] == ["estop", "temperature", "motor"]


def test_what_was_cut_once_can_be_cut_again() -> None:
    found = share("base")

    again = share_of(found.model, found.robot)

    assert again.model == found.model
    assert names(again.robot) == names(found.robot)


def test_an_unknown_device_is_told_with_the_known_ones() -> None:
    with pytest.raises(InvalidRobotFileError, match="there is no device 'bas'; known: base"):
        share("bas")
    with pytest.raises(UnknownDeviceError):
        share_of(MODEL, RobotSettings(device="base"))


# --- the supervisor ------------------------------------------------------------------------------


def test_the_supervisor_supervises_everything_and_reaches_what_no_device_owns() -> None:
    found = share()

    assert found.model is MODEL
    assert (*found.local_model.nodes,) == (ARM,)
    assert found.local_model.systems == {}
    assert [*found.local_robot.nodes] == [ARM]


def test_the_supervisor_restores_nodes_of_devices_too() -> None:
    assert share().robot.to_change_settings().restored_nodes == {BASE, ARM}


def test_each_computer_reports_the_diagnostics_of_its_own_parts() -> None:
    model = read_model(REACTING).model
    text = """
devices: {base: {parts: [drive_base]}}
ros2: {diagnostics: {errors: {motor: drive_base.HOT, grip: manipulator.LOOSE}}}
"""
    at_base = share_of(model, read_robot_file(written_for_device(text, "base"), model)).local_robot
    here = share_of(model, read_robot_file(text, model)).local_robot
    only_base = share_of(
        model, read_robot_file(text.replace(", grip: manipulator.LOOSE", ""), model)
    ).local_robot

    assert at_base.ros2.diagnostics is not None
    assert [*at_base.ros2.diagnostics.errors.values()] == ["drive_base.HOT"]
    assert here.ros2.diagnostics is not None
    assert [*here.ros2.diagnostics.errors.values()] == ["manipulator.LOOSE"]
    assert only_base.ros2.diagnostics is None


def test_the_supervisor_has_all_signals_and_reads_those_of_no_device() -> None:
    found = share()

    assert set(names(found.robot)) > {signal.spec.name for signal in default_signals()}
    assert "motor" not in found.robot.signals.sources
    assert "temperature" not in found.local_robot.signals.sources
    assert found.read_elsewhere == {"motor", "temperature"}
    assert [*found.robot.ros2.signals] == ["load"]


def test_a_signal_goes_stale_at_the_supervisor_as_it_does_where_it_is_read() -> None:
    at_device, at_supervisor = share("base").robot, share().robot

    for name in ("motor", "temperature"):
        (one,) = [s for s in at_device.to_signal_settings() if s.spec.name == name]
        (other,) = [s for s in at_supervisor.to_signal_settings() if s.spec.name == name]
        assert one.stale_after == other.stale_after > 0


def test_a_supervisor_of_devices_that_own_everything_reaches_no_node_itself() -> None:
    found = share(text="devices: {all: {parts: [actuation]}}")

    assert found.local_model.parts == ()


REACTING = """
drive_base: {ros__parameters: {type: node, errors: {HOT: {}},
  reactions: {COOL: {when: "drive_base.errors.HOT", action: state, target: inactive},
              HALT: {when: "drive_base.errors.HOT", action: stop}}}}
manipulator: {ros__parameters: {type: node, errors: {LOOSE: {}},
  reactions: {REST: {when: "not manipulator.reachable", action: state, target: inactive}}}}
"""


def test_each_reaction_is_decided_about_where_all_of_it_is() -> None:
    model = read_model(REACTING).model
    robot = read_robot_file("devices: {base: {parts: [drive_base]}}", model)

    assert reactions_of_devices(model, robot) == {"COOL": "base"}
    assert reactions_of_devices(model, RobotSettings()) == {}
    assert [*share_of(model, robot.model_copy(update={"device": "base"})).model.reactions] == [BASE]
