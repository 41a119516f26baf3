"""Parts begin and end in turn, and time passes as far as that takes."""

from domain.lifecycle import LifecycleState
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.plans.scope import Links, Scope
from domain.plans.walk import Walk
from domain.state_and_mode import DEFAULT_MODE, PartName, StateAndMode

ACTIVE = StateAndMode(LifecycleState.ACTIVE)
ROBOT, LEGS, LEFT, RIGHT, ARM = map(PartName, ("robot", "legs", "left", "right", "arm"))
MODEL = SmhModel(
    {name: NodeModel(name, {}) for name in (LEFT, RIGHT, ARM)},
    {
        ROBOT: SystemModel(ROBOT, {DEFAULT_MODE: {LEGS: ACTIVE, ARM: ACTIVE}}),
        LEGS: SystemModel(LEGS, {DEFAULT_MODE: {LEFT: ACTIVE, RIGHT: ACTIVE}}),
    },
)


def _legs_after_arm(*nodes: PartName) -> Scope:
    links = {ROBOT: Links({LEGS: (ARM,)}, {ARM: (LEGS,)})}
    return Scope(MODEL, ROBOT, dict.fromkeys(nodes or MODEL.nodes), links)


def test_a_part_is_looked_at_only_when_its_turn_comes() -> None:
    walk = Walk(_legs_after_arm())
    assert walk.begins == {ROBOT: 0, ARM: 0}
    assert walk.done(ARM) == [LEFT, RIGHT]
    assert walk.begins[LEGS] == 1


def test_a_system_ends_with_the_last_of_its_parts() -> None:
    walk = Walk(_legs_after_arm(), {ARM: 5, LEFT: 2, RIGHT: 3}).to_the_end()
    assert walk.begins[LEFT] == 5
    assert walk.ends[ROBOT] == 8


def test_a_part_without_nodes_takes_no_time() -> None:
    walk = Walk(_legs_after_arm(LEFT, RIGHT))
    assert walk.begins[LEFT] == 0
    assert walk.to_the_end().ends[ROBOT] == 1
