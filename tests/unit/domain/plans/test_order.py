"""In which order nodes begin; each stage is what may run side by side."""

from collections.abc import Iterator

import hypothesis.strategies as st
from hypothesis import given

from domain.lifecycle import LifecycleState
from domain.parts.mode_settings import ModeSettings, TransitionSettings
from domain.parts.system_model import EVERY_MODE, NodeModel, SmhModel, SystemModel
from domain.plans.order import Order, order_of
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode

ACTIVE = StateAndMode(LifecycleState.ACTIVE)


def _model(
    systems: dict[str, list[str]], after: dict[str, dict[str, list[str]]] | None = None
) -> SmhModel:
    """Return a model of systems, the root first; all that are no systems are nodes."""
    names = [name for parts in systems.values() for name in parts if name not in systems]
    settings = {
        PartName(system): {
            EVERY_MODE: ModeSettings(
                transition=TransitionSettings(
                    {PartName(k): tuple(map(PartName, v)) for k, v in waits.items()}
                )
            )
        }
        for system, waits in (after or {}).items()
    }
    return SmhModel(
        {PartName(name): NodeModel(PartName(name), {}) for name in names},
        {
            PartName(name): SystemModel(
                PartName(name), {DEFAULT_MODE: {PartName(part): ACTIVE for part in parts}}
            )
            for name, parts in systems.items()
        },
        settings,
    )


def _order(model: SmhModel, *left_out: str, is_reversed: bool = False) -> Order:
    root = model.parts[0]
    nodes = [node for node in model.nodes_below(root) if node not in left_out]
    return order_of(
        model,
        root,
        nodes,
        lambda system: model.settings_of(system, DEFAULT_MODE).transition,
        is_reversed=is_reversed,
    )


def _stages(model: SmhModel, *left_out: str, is_reversed: bool = False) -> dict[str, int]:
    order = _order(model, *left_out, is_reversed=is_reversed)
    nodes = model.nodes_below(model.parts[0])
    return {str(node): order.stage(node) for node in nodes if node not in left_out}


ROBOT = {"robot": ["base", "arm", "lidar"]}
IN_A_ROW = {"arm": ["base"], "lidar": ["arm"]}


def test_without_settings_all_nodes_begin_at_once() -> None:
    order = _order(_model(ROBOT))
    assert not order.blocked
    assert order.stages == 1


def test_in_a_row_each_part_waits_for_the_one_before() -> None:
    model = _model(ROBOT, {"robot": IN_A_ROW})
    order = _order(model)
    assert _stages(model) == {"base": 0, "arm": 1, "lidar": 2}
    assert order.after(PartName("lidar")) == ("arm",)
    assert order.after(PartName("base")) == ()


def test_a_part_is_released_when_the_one_before_is_done() -> None:
    order = _order(_model(ROBOT, {"robot": IN_A_ROW}))
    assert order.done(PartName("base")) == ["arm"]
    assert order.done(PartName("arm")) == ["lidar"]
    assert not order.blocked


def test_a_part_that_waits_for_two_is_released_by_the_second() -> None:
    order = _order(_model(ROBOT, {"robot": {"lidar": ["base", "arm"]}}))
    assert order.done(PartName("arm")) == []
    assert order.done(PartName("base")) == ["lidar"]


def test_going_down_is_the_same_in_reverse() -> None:
    model = _model(ROBOT, {"robot": IN_A_ROW})
    assert _stages(model, is_reversed=True) == {"base": 2, "arm": 1, "lidar": 0}


def test_who_waits_for_a_part_without_nodes_in_the_change_waits_for_what_it_waits_for() -> None:
    model = _model(ROBOT, {"robot": IN_A_ROW})
    assert _stages(model, "arm") == {"base": 0, "lidar": 1}
    assert _order(model, "arm").after(PartName("lidar")) == ("base",)


NESTED = {"robot": ["legs", "arm"], "legs": ["left", "right"]}


def test_a_system_inside_another_one_orders_its_own_parts() -> None:
    model = _model(NESTED, {"robot": {"legs": ["arm"]}, "legs": {"right": ["left"]}})
    assert _stages(model) == {"arm": 0, "left": 1, "right": 2}
    order = _order(model)
    assert order.after(PartName("left")) == ("arm",)
    assert order.after(PartName("right")) == ("left",), "and so after arm"


def test_who_waits_for_a_system_waits_for_its_last_nodes() -> None:
    model = _model(NESTED, {"robot": {"arm": ["legs"]}, "legs": {"right": ["left"]}})
    order = _order(model)
    assert _stages(model) == {"left": 0, "right": 1, "arm": 2}
    assert order.after(PartName("arm")) == ("right",)


def test_orders_of_systems_that_share_nodes_and_exclude_each_other_do_not_count() -> None:
    shared = {"robot": ["one", "two"], "one": ["a", "b"], "two": ["a", "b"]}
    model = _model(shared, {"one": {"a": ["b"]}, "two": {"b": ["a"]}})
    order = _order(model)
    assert not order.blocked
    assert _stages(model) == {"a": 0, "b": 0}


def test_a_part_is_waited_for_past_one_without_nodes_inside_a_system() -> None:
    model = _model(NESTED, {"robot": {"arm": ["legs"]}, "legs": {"right": ["left"]}})
    assert _order(model, "right").after(PartName("arm")) == ("left",)


def test_a_node_that_only_another_mode_names_is_waited_for() -> None:
    legs, arm, extra = PartName("legs"), PartName("arm"), PartName("extra")
    fast = ModeName("FAST")
    wants = {
        DEFAULT_MODE: {PartName("left"): ACTIVE},
        fast: {PartName("left"): ACTIVE, extra: ACTIVE},
    }
    model = _model({"robot": ["legs", "arm"], "legs": ["left"]}, {"robot": {"arm": ["legs"]}})
    model = SmhModel(
        {**model.nodes, extra: NodeModel(extra, {})},
        {**model.systems, legs: SystemModel(legs, wants)},
        model.mode_settings,
    )
    nodes = (PartName("left"), extra, arm)
    order = order_of(
        model, PartName("robot"), nodes, lambda name: model.settings_of(name, None).transition
    )
    assert order.done(PartName("left")) == []
    assert order.done(extra) == [arm]


# --- any order -----------------------------------------------------------------------------------


@st.composite
def _models(draw: st.DrawFn) -> SmhModel:
    """Return a tree of systems, in each of which parts wait for some that stand before them."""
    systems: dict[str, list[str]] = {"s0": []}
    after: dict[str, dict[str, list[str]]] = {}
    for number in range(draw(st.integers(1, 4))):
        parent = draw(st.sampled_from(sorted(systems)))
        if number:
            systems[f"s{number}"] = []
            systems[parent].append(f"s{number}")
    for name, parts in systems.items():
        parts += [f"{name}_n{number}" for number in range(draw(st.integers(1, 4)))]
        after[name] = {
            part: draw(st.lists(st.sampled_from(parts[:place]), unique=True))
            for place, part in enumerate(parts)
            if place
        }
    return _model(systems, after)


@given(_models(), st.booleans(), st.data())
def test_whatever_ends_first_nothing_begins_before_what_it_waits_for(
    model: SmhModel, is_reversed: bool, data: st.DataObject
) -> None:
    order = _order(model, is_reversed=is_reversed)
    running = [node for node in model.nodes if node not in order.blocked]
    ended: list[PartName] = []
    while running:
        node = data.draw(st.sampled_from(running))
        running.remove(node)
        ended.append(node)
        released = order.done(node)
        running += released
        for begun in released:
            assert set(order.after(begun)) <= set(ended)
            assert order.stage(begun) == 1 + max(map(order.stage, order.after(begun)))
    assert sorted(ended) == sorted(model.nodes), "every node begins"
    for later, earlier in _waits(model):
        if is_reversed:
            later, earlier = earlier, later
        ends = [ended.index(node) for node in model.nodes_below(earlier)]
        begins = [ended.index(node) for node in model.nodes_below(later)]
        assert max(ends) < min(begins)


def _waits(model: SmhModel) -> Iterator[tuple[PartName, PartName]]:
    """Return each part that waits, with each of those that it waits for."""
    for system in model.systems:
        for part, before in model.settings_of(system, DEFAULT_MODE).transition.after.items():
            yield from ((part, name) for name in before)
