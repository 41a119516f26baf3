"""What is ordered: which parts are inside, and who waits for whom."""

from domain.lifecycle import LifecycleState
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.plans.scope import Links, Scope
from domain.state_and_mode import DEFAULT_MODE, PartName, StateAndMode

ACTIVE = StateAndMode(LifecycleState.ACTIVE)
ROBOT, ONE, TWO, A, B = map(PartName, ("robot", "one", "two", "a", "b"))
SHARED = SmhModel(
    {name: NodeModel(name, {}) for name in (A, B)},
    {
        ROBOT: SystemModel(ROBOT, {DEFAULT_MODE: {ONE: ACTIVE, TWO: ACTIVE}}),
        ONE: SystemModel(ONE, {DEFAULT_MODE: {A: ACTIVE, B: ACTIVE}}),
        TWO: SystemModel(TWO, {DEFAULT_MODE: {A: ACTIVE}}),
    },
)
IN_A_ROW = Links({B: (A,)}, {A: (B,)})


def _scope(part: PartName, *nodes: PartName) -> Scope:
    return Scope(SHARED, part, dict.fromkeys(nodes), {ONE: IN_A_ROW})


def test_a_part_is_shared_if_several_systems_inside_have_it() -> None:
    assert _scope(ROBOT, A, B).systems_of(A) == (ONE, TWO)
    assert _scope(ROBOT, A, B).has_shared_parts
    assert _scope(ONE, A, B).systems_of(A) == (ONE,)
    assert not _scope(ONE, A, B).has_shared_parts


def test_where_a_node_waits_is_told_by_system_and_part() -> None:
    assert list(_scope(ROBOT, A, B).places(B)) == [(ONE, B)]
    assert list(_scope(ROBOT, A, B).places(A)) == []


def test_a_shared_part_without_nodes_is_left_out() -> None:
    scope = _scope(ROBOT, B).without_empty()
    assert scope.inside(ONE) == (B,)
    assert not scope.inside(TWO)
    assert scope.links[ONE].before[B] == ()


def test_on_the_way_back_who_was_waited_for_waits() -> None:
    back = _scope(ROBOT, A, B).turned([A, B])
    assert back.links[ONE] == Links({A: (B,)}, {B: (A,)})


def test_a_freed_part_waits_for_nothing() -> None:
    free = _scope(ROBOT, A, B).freed([(ONE, B)])
    assert free.links[ONE] == Links({}, {A: ()})


def test_a_part_is_waited_for_if_one_with_nodes_comes_after_it() -> None:
    assert _scope(ROBOT, A, B).is_waited_for(ONE, A)
    assert not _scope(ROBOT, A, B).is_waited_for(ONE, B)
    assert not _scope(ROBOT, A).is_waited_for(ONE, A)
