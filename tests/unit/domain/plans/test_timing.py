"""When parts begin and end, if every node takes its time."""

from domain.lifecycle import LifecycleState
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.plans.scope import Links, Scope
from domain.plans.timing import Timing
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


def test_a_system_ends_with_the_last_of_its_parts() -> None:
    timing = Timing(_legs_after_arm(), {ARM: 5, LEFT: 2, RIGHT: 3})
    assert timing.begin(LEFT) == 5
    assert timing.end(ROBOT) == 8


def test_without_times_each_node_is_a_stage() -> None:
    timing = Timing(_legs_after_arm())
    assert [timing.begin(part) for part in (ARM, LEFT, RIGHT)] == [0, 1, 1]


def test_a_part_without_nodes_takes_no_time() -> None:
    timing = Timing(_legs_after_arm(LEFT, RIGHT))
    assert timing.begin(LEFT) == 0
    assert timing.end(ROBOT) == 1
