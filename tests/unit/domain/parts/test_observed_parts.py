import pytest

from domain.errors import UnknownPartError
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.parts.observed_parts import AnnouncedTarget, ObservedParts
from domain.parts.parts import LOOKS_AT_ONCE
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from domain.timebase import seconds
from tests.support.models import (
    ACTUATION,
    ARM,
    BASE,
    FAST,
    MODERATE,
    PERFORMANCE,
    STRONG,
    active,
    actuation_model,
    inactive,
)

S = LifecycleState
NOW = seconds(1.0)


@pytest.fixture
def parts() -> ObservedParts:
    return ObservedParts(actuation_model())


def announce(
    parts: ObservedParts,
    part: PartName,
    mode: str | None = None,
    state: S = S.ACTIVE,
    stamp: int = 0,
) -> None:
    named = None if mode is None else ModeName(mode)
    parts.take_target(AnnouncedTarget(part, state, named, stamp), NOW)


def report(parts: ObservedParts, node: PartName, state: S, **parameters: float | str) -> None:
    said = NodeReport(node, state=state, parameters=parameters, reachable=True)
    parts.take_report(said, NOW)


def actual(parts: ObservedParts, part: PartName) -> StateAndMode:
    return parts.view(part).actual.state_and_mode


def target(parts: ObservedParts, part: PartName) -> StateAndMode | None:
    return parts.view(part).target


def test_at_first_no_node_is_reachable_and_nothing_has_a_target(parts: ObservedParts) -> None:
    assert not parts.view(BASE).reachable
    assert actual(parts, ACTUATION) == StateAndMode(S.UNKNOWN)
    assert target(parts, ACTUATION) is None


def test_without_targets_a_system_is_in_the_state_that_its_nodes_share(
    parts: ObservedParts,
) -> None:
    report(parts, BASE, S.INACTIVE)
    report(parts, ARM, S.INACTIVE)

    assert actual(parts, ACTUATION) == inactive()
    assert parts.view(ACTUATION).actual.inferred


def test_with_its_target_a_system_is_in_the_mode_that_its_nodes_make_up(
    parts: ObservedParts,
) -> None:
    for part, mode in ((ACTUATION, PERFORMANCE), (BASE, FAST), (ARM, STRONG)):
        announce(parts, part, mode)
    report(parts, BASE, S.ACTIVE, max_speed=0.9, controller="MPC")
    report(parts, ARM, S.ACTIVE, max_torque=0.2)

    assert actual(parts, ACTUATION) == active(PERFORMANCE)
    assert actual(parts, BASE) == active(FAST)
    assert parts.view(ACTUATION).converged


def test_nodes_that_were_moved_on_purpose_leave_their_system_on_its_way(
    parts: ObservedParts,
) -> None:
    announce(parts, ACTUATION, PERFORMANCE)
    report(parts, BASE, S.ACTIVE, max_speed=0.2, controller="PID")
    report(parts, ARM, S.ACTIVE, max_torque=0.15)

    assert actual(parts, ACTUATION) == StateAndMode(S.ACTIVATING, MODERATE)
    assert parts.view(ACTUATION).deviation_since == NOW


def test_active_without_a_mode_means_the_default_mode(parts: ObservedParts) -> None:
    announce(parts, ACTUATION)

    assert target(parts, ACTUATION) == active(DEFAULT_MODE)


def test_a_part_without_modes_is_only_to_be_active() -> None:
    lamp = PartName("lamp")
    parts = ObservedParts(SmhModel({lamp: NodeModel(lamp, {})}, {}))

    announce(parts, lamp)

    assert target(parts, lamp) == StateAndMode(S.ACTIVE)


def test_of_two_topics_that_come_late_the_later_stamp_counts(parts: ObservedParts) -> None:
    announce(parts, ACTUATION, PERFORMANCE, stamp=20)
    announce(parts, ACTUATION, state=S.INACTIVE, stamp=10)

    assert target(parts, ACTUATION) == active(PERFORMANCE)

    announce(parts, ACTUATION, state=S.INACTIVE, stamp=30)

    assert target(parts, ACTUATION) == inactive()


def test_of_one_topic_the_last_message_counts_also_if_a_clock_was_set_back(
    parts: ObservedParts,
) -> None:
    announce(parts, ACTUATION, PERFORMANCE, stamp=20)
    announce(parts, ACTUATION, MODERATE, stamp=10)

    assert target(parts, ACTUATION) == active(MODERATE)


def test_without_stamps_as_from_system_modes_what_comes_last_counts(
    parts: ObservedParts,
) -> None:
    announce(parts, BASE, state=S.ACTIVE)
    announce(parts, BASE, FAST)
    announce(parts, ARM, STRONG)
    announce(parts, ARM, state=S.INACTIVE)

    assert target(parts, BASE) == active(FAST)
    assert target(parts, ARM) == inactive()


def test_a_mode_of_another_model_is_shown_and_never_reached(parts: ObservedParts) -> None:
    announce(parts, ACTUATION, "FLYING")
    report(parts, BASE, S.ACTIVE, max_speed=0.1, controller="PID")
    report(parts, ARM, S.INACTIVE)

    assert target(parts, ACTUATION) == active("FLYING")
    assert actual(parts, ACTUATION).state is S.ACTIVATING


def test_only_what_changed_is_told_and_once(parts: ObservedParts) -> None:
    report(parts, BASE, S.INACTIVE)

    assert parts.take_changed() >= {BASE, ACTUATION}
    assert parts.take_changed() == set()


def test_a_part_that_is_not_in_the_model_is_refused(parts: ObservedParts) -> None:
    with pytest.raises(UnknownPartError):
        announce(parts, PartName("wing"), "FAST")
    with pytest.raises(UnknownPartError):
        report(parts, PartName("wing"), S.ACTIVE)


def test_of_a_large_robot_every_deviation_is_dated_at_once() -> None:
    nodes = {
        name: NodeModel(name, {})
        for name in (PartName(f"n{number}") for number in range(3 * LOOKS_AT_ONCE))
    }
    robot = PartName("robot")
    wanted = {name: StateAndMode(S.ACTIVE) for name in nodes}
    parts = ObservedParts(SmhModel(nodes, {robot: SystemModel(robot, {DEFAULT_MODE: wanted})}))
    for node in nodes:
        report(parts, node, S.INACTIVE)
        announce(parts, node)
    announce(parts, robot)

    assert all(parts.view(part).deviation_since == NOW for part in (robot, *nodes))
