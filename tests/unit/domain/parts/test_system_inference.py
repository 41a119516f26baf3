"""A system is inferred part by part, and comes to what the rules say of all parts together."""

from collections.abc import Sequence

import hypothesis.strategies as st
import pytest
from hypothesis import given

from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.parts.mode_inference import ModeInference
from domain.parts.system_inference import SystemInference
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.snapshot import Actual
from domain.state_and_mode import DEFAULT_MODE, PartName, StateAndMode
from tests.support.big_model import FAN_OUT, FAST, PARAMETERS, big_model
from tests.support.random_models import Happening, SetTarget, histories, models
from tests.support.straight_inference import inferred

ACTIVE, INACTIVE = LifecycleState.ACTIVE, LifecycleState.INACTIVE


class Counted:
    """How often systems were inferred, and how often parts were noted."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.inferred = self.noted = 0
        infer, note = SystemInference.infer, SystemInference.note

        def count_infer(system: SystemInference, target: StateAndMode | None) -> Actual:
            self.inferred += 1
            return infer(system, target)

        def count_note(
            system: SystemInference, part: PartName, actual: Actual, *, plain: bool
        ) -> None:
            self.noted += 1
            note(system, part, actual, plain=plain)

        monkeypatch.setattr(SystemInference, "infer", count_infer)
        monkeypatch.setattr(SystemInference, "note", count_note)

    def begin(self) -> None:
        """Count from here."""
        self.inferred = self.noted = 0


def check(inference: ModeInference) -> None:
    """Compare every system with the rules written down straight."""
    model = inference.model
    actuals = {part: inference.actual(part) for part in model.parts}
    plain = frozenset(n for n, facts in inference.facts.items() if not facts.has_lifecycle)
    for name, system in model.systems.items():
        assert inference.actual(name) == inferred(system, inference.target(name), actuals, plain)


@given(st.data())
def test_whatever_happens_the_rules_hold_for_all_parts_together(data: st.DataObject) -> None:
    model = data.draw(models())
    happenings: Sequence[Happening] = data.draw(histories(model))
    inference = ModeInference(model)
    check(inference)
    for happening in happenings:
        if isinstance(happening, SetTarget):
            inference.set_targets({happening.part: happening.target})
        else:
            inference.report(happening)
        check(inference)


def test_a_report_concerns_only_the_systems_that_it_changes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of 1,111 systems, the one above the node is looked at, and none above that stays as it is."""
    inference = at_rest(big_model(10_000), {})
    counted = Counted(monkeypatch)
    inference.report(NodeReport(PartName("node_5000"), LifecycleState.ACTIVATING))
    # Its system becomes undecided, and so do those above, whose reason that is.
    assert (counted.inferred, counted.noted) == (4, 4)
    counted.begin()
    inference.report(NodeReport(PartName("node_5001"), LifecycleState.ACTIVATING))
    assert counted.inferred <= 4


def test_while_a_large_robot_changes_only_the_parent_of_a_node_is_inferred(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    model = big_model(1_000)
    wanted = StateAndMode(ACTIVE, FAST)
    inference = at_rest(model, dict.fromkeys(model.parts, wanted))
    counted = Counted(monkeypatch)
    for node in model.nodes:
        inference.report(NodeReport(node, ACTIVE, parameters=PARAMETERS[FAST]))
    assert inference.actual(model.parts[0]).state_and_mode == wanted
    # One per report, and one more whenever a system of ten has got there.
    assert counted.inferred <= len(model.nodes) * (1 + 2 / FAN_OUT)


def test_a_report_of_one_among_ten_thousand_parts_of_a_system_looks_at_no_other(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    nodes = {PartName(f"n{number}"): NodeModel(PartName(f"n{number}")) for number in range(10_000)}
    default = dict.fromkeys(nodes, StateAndMode(INACTIVE))
    flat = SystemModel(PartName("flat"), {DEFAULT_MODE: default})
    inference = at_rest(SmhModel(nodes, {flat.name: flat}), {})
    looked: list[PartName] = []
    monkeypatch.setattr(inference, "_actual", Looked(inference._actual, looked))  # noqa: SLF001
    inference.report(NodeReport(PartName("n77"), LifecycleState.ACTIVATING))
    assert set(looked) == {"n77", "flat"}
    assert inference.actual(flat.name).undecidable


class Looked(dict[PartName, Actual]):
    """States of parts that write down who was asked for."""

    def __init__(self, states: dict[PartName, Actual], looked: list[PartName]) -> None:
        super().__init__(states)
        self._looked = looked

    def __getitem__(self, part: PartName) -> Actual:
        """Return the state of a part."""
        self._looked.append(part)
        return super().__getitem__(part)


def at_rest(model: SmhModel, targets: dict[PartName, StateAndMode]) -> ModeInference:
    """Return a robot whose nodes are all inactive."""
    inference = ModeInference(model)
    inference.set_targets(targets)
    for node in model.nodes:
        inference.report(NodeReport(node, INACTIVE))
    return inference
