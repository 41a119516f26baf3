"""Parts begin and end in turn."""

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
    assert walk.begun == {ROBOT, ARM}
    assert walk.done(ARM) == [LEFT, RIGHT]
    assert LEGS in walk.begun


def test_a_part_without_nodes_is_done_when_its_turn_comes() -> None:
    assert {LEFT, RIGHT} <= Walk(_legs_after_arm(LEFT, RIGHT)).begun


def test_at_the_end_all_have_begun() -> None:
    assert Walk(_legs_after_arm()).to_the_end().begun == set(MODEL.parts)
