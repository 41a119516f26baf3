"""Rules, fallbacks and reactions wait until every device was heard, or could have been."""

from dataclasses import replace

import pytest

from domain.changes.settings import ChangeSettings
from domain.commands import AskTransition
from domain.computers import DeviceState
from domain.conditions.condition import Condition
from domain.inputs import ModeRequest, Reading, Readings
from domain.lifecycle import Transition
from domain.parts.declared_reactions import DeclaredReaction
from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import SmhModel
from domain.reaction_terms import Action, ReactionState
from domain.snapshot import Because
from domain.state_and_mode import DEFAULT_MODE
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from tests.support.models import (
    ACTUATION,
    ARM,
    BASE,
    PERFORMANCE,
    actuation_model,
    inactive,
)
from tests.support.robot_of_devices import (
    ARM_COMPUTER,
    BASE_COMPUTER,
    DEVICES,
    SILENT,
    RobotOfDevices,
)
from tests.support.ruled_robot import degrading_model

PATIENT = SupervisionSettings(devices=DEVICES, devices_heard_within=seconds(3))
"""Waits longer than for nodes that were not heard yet."""


def reacting_model(when: str) -> SmhModel:
    """Return a robot that holds its task while something is so."""
    halt = DeclaredReaction("HALT", ACTUATION, Condition(when), Action.HOLD)
    return replace(actuation_model(), reactions={ACTUATION: {"HALT": halt}})


def falling_model() -> SmhModel:
    """Return a robot whose PERFORMANCE falls back to the default mode without its base."""
    settings = ModeSettings(
        invariants=(Condition("drive_base.reachable"),), grace=0, fallback=DEFAULT_MODE
    )
    return replace(actuation_model(), mode_settings={ACTUATION: {PERFORMANCE: settings}})


def acts(robot: RobotOfDevices) -> bool:
    return robot.core.reaction_of(ACTUATION, "HALT").state is ReactionState.ACTING


# --- reactions -----------------------------------------------------------------------------------


def test_a_reaction_waits_for_a_device_that_was_not_heard() -> None:
    robot = RobotOfDevices(reacting_model("drive_base.state == unconfigured"), PATIENT)
    robot.connect(BASE_COMPUTER).advance(2.9)
    assert not acts(robot)

    robot.advance(0.2)

    assert acts(robot)


def test_a_reaction_acts_as_soon_as_all_devices_were_heard() -> None:
    robot = RobotOfDevices(reacting_model("drive_base.state == unconfigured"), PATIENT)
    robot.connect(BASE_COMPUTER).advance(1)
    assert not acts(robot)

    robot.connect(ARM_COMPUTER)

    assert acts(robot)


def test_a_device_that_comes_in_time_is_not_taken_for_one_that_is_missing() -> None:
    robot = RobotOfDevices(reacting_model("not manipulator.reachable"), PATIENT)
    robot.connect(BASE_COMPUTER).advance(2.9)
    robot.says(DeviceState.CONNECTED, ARM_COMPUTER)
    assert not acts(robot)

    robot.hears(ARM).advance(10)

    assert robot.happened("reaction.*") == []


def test_a_device_that_does_not_come_is_missing_once_the_time_is_over() -> None:
    robot = RobotOfDevices(reacting_model("not manipulator.reachable"), PATIENT)
    robot.connect(BASE_COMPUTER).advance(2.9)
    assert not acts(robot)

    robot.advance(0.1)

    assert acts(robot)


def test_a_device_that_is_lost_later_is_not_waited_for() -> None:
    robot = RobotOfDevices(reacting_model("not manipulator.reachable"), PATIENT)
    robot.connect_all().advance(10)

    robot.lose()

    assert acts(robot)


def test_a_reaction_of_an_earlier_run_stands_while_it_waits() -> None:
    robot = RobotOfDevices(reacting_model("drive_base.state == unconfigured"), PATIENT)
    robot.connect_all().advance(5)
    assert acts(robot)

    robot.restart()
    assert acts(robot)

    robot.connect_all("inactive").advance(1)
    assert not acts(robot)


def test_a_robot_of_one_computer_waits_for_nobody() -> None:
    core = Supervision(
        reacting_model("battery_level < 0.2"), SupervisionSettings(devices_heard_within=10), 0
    )
    core.handle(Readings((Reading("battery_level", 0.1),), "test"), 1)

    assert core.reaction_of(ACTUATION, "HALT").state is ReactionState.ACTING


# --- rules and fallbacks -------------------------------------------------------------------------


def performing(model: SmhModel, settings: SupervisionSettings) -> RobotOfDevices:
    """Return a robot in PERFORMANCE whose supervisor then starts anew."""
    robot = RobotOfDevices(model, settings).connect_all().advance(5)
    robot.give(ModeRequest(ACTUATION, PERFORMANCE))
    robot.obey().advance(5)
    assert robot.core.part(ACTUATION).actual.state_and_mode.label == "active.PERFORMANCE"
    return robot.restart()


def because(robot: RobotOfDevices) -> Because | None:
    effective = robot.core.part(ACTUATION).effective_target
    return None if effective is None else effective.because


def test_a_rule_waits_for_all_devices() -> None:
    robot = performing(degrading_model(), PATIENT)
    robot.connect(BASE_COMPUTER, "inactive").advance(2.9)
    assert because(robot) is Because.REQUESTED

    robot.advance(0.2)

    assert because(robot) is Because.RULE


def test_a_fallback_waits_for_all_devices() -> None:
    robot = performing(falling_model(), PATIENT)
    robot.connect(ARM_COMPUTER, "active").hears(BASE, reachable=False).advance(2.9)
    assert because(robot) is Because.REQUESTED

    robot.advance(0.2)

    assert because(robot) is Because.INVARIANT


def test_a_supervisor_that_starts_again_commands_nothing_by_itself() -> None:
    robot = performing(degrading_model(), PATIENT)

    robot.connect_all("inactive").advance(10)

    assert robot.commands == []
    assert robot.core.part(ACTUATION).target is not None


# --- what returns --------------------------------------------------------------------------------


SAME_OR_OTHER_RUN = pytest.mark.parametrize("run", [1, 2], ids=["returns", "was restarted"])


def lost_and_back(robot: RobotOfDevices, run: int) -> RobotOfDevices:
    """Return a robot whose arm was active; its device was lost, and is back without that.

    Args:
        robot: No device was heard yet.
        run: Of the device that is back; 1: its process went on.
    """
    robot.connect_all().advance(5)
    robot.give(ModeRequest(ACTUATION, PERFORMANCE))
    robot.obey().advance(5)
    robot.lose().advance(5)
    robot.commands.clear()
    return robot.connect(run=run)


@SAME_OR_OTHER_RUN
def test_a_node_that_is_to_be_restored_is_when_its_device_returns(run: int) -> None:
    changes = ChangeSettings(restored_nodes=frozenset({ARM}))
    robot = RobotOfDevices(settings=SupervisionSettings(devices=DEVICES, changes=changes))
    back = lost_and_back(robot, run)
    (asked,) = back.commands
    assert isinstance(asked, AskTransition)
    assert (asked.node, asked.transition) == (ARM, Transition.CONFIGURE)

    back.obey().advance(1)

    assert back.core.part(ACTUATION).converged
    assert len(back.happened("node.restoring")) == 1


@SAME_OR_OTHER_RUN
def test_any_other_node_stays_as_it_is_until_somebody_asks(run: int) -> None:
    robot = lost_and_back(RobotOfDevices(), run)
    robot.advance(60)

    assert robot.commands == []
    assert robot.core.part(ARM).target is not None
    assert robot.core.part(ARM).deviation_reason == (
        "manipulator is unconfigured, target active.STRONG"
    )
    assert robot.error("manipulator.DEVIATES").state.is_on

    robot.give(ModeRequest(ACTUATION, PERFORMANCE))
    robot.obey().advance(1)

    assert robot.core.part(ACTUATION).converged


def test_a_node_that_is_where_it_should_be_moves_nothing_when_its_device_returns() -> None:
    robot = RobotOfDevices().connect_all("inactive").advance(5)
    robot.lose(reason=SILENT).advance(5)

    robot.connect(state="inactive").advance(5)

    assert robot.commands == []
    assert robot.core.part(ARM).actual.state_and_mode == inactive()
