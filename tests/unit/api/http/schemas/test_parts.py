"""Systems, nodes and their parameters as clients see them."""

import pytest

from api.http.schemas.parts import ModeJson, ParameterRowJson, PartJson, StateJson, type_of
from domain.findings import Blocker
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import ParameterValue
from domain.snapshot import Actual, Because, EffectiveTarget, ParameterView, PartView
from domain.state_and_mode import ModeName, PartName, StateAndMode
from domain.timebase import seconds
from tests.support.manual_clock import ManualClock

FAST = StateAndMode(LifecycleState.ACTIVE, ModeName("FAST"))
VIEW = PartView(
    name=PartName("drive_base"),
    kind="node",
    parts=(),
    target=FAST,
    effective_target=EffectiveTarget(
        LifecycleState.ACTIVE,
        ModeName("SLOW"),
        Because.RULE,
        "slow_down",
        7,
        (Blocker("RULE", "arm is inactive", ("robot", "arm"), since=seconds(1)),),
    ),
    actual=Actual(LifecycleState.ACTIVE, ModeName("SLOW"), mode_inferred=True),
    converged=False,
    deviation_since=seconds(2),
    deviation_reason="drive_base is active.SLOW, target active.FAST",
    reachable=True,
    change=None,
)


def test_a_part_tells_what_was_asked_what_is_pursued_and_what_is() -> None:
    shown = PartJson.of(VIEW, ManualClock())

    assert (shown.target and shown.target.mode) == "FAST"
    assert shown.effective_target is not None
    pursued = shown.effective_target.model_dump(mode="json")
    blockers = pursued.pop("blockers")
    assert pursued == {
        "state": "active",
        "mode": "SLOW",
        "because": "rule",
        "rule": "slow_down",
        "reaction": None,
        "cause": 7,
    }
    assert blockers[0]["message"] == "arm is inactive"
    assert blockers[0]["since_at"] == "2026-01-01T00:00:01.000Z"
    assert shown.actual.mode == "SLOW"
    assert shown.deviation_since_at == "2026-01-01T00:00:02.000Z"
    assert shown.deviation_reason == "drive_base is active.SLOW, target active.FAST"


def test_state_and_mode_tell_the_target_as_a_label() -> None:
    state = StateJson.of(VIEW, (Transition.DEACTIVATE,))

    assert (state.target, ModeJson.of(VIEW).target) == ("active.FAST", "active.FAST")
    assert state.available_transitions == [Transition.DEACTIVATE]


@pytest.mark.parametrize(
    ("value", "name"),
    [
        (True, "bool"),
        (1, "integer"),
        (1.0, "double"),
        ("x", "string"),
        ((True,), "bool_array"),
        ((1,), "integer_array"),
        ((1.0,), "double_array"),
        (("x",), "string_array"),
        ((), None),
        (None, None),
    ],
)
def test_types_are_called_as_in_ros(value: ParameterValue | None, name: str | None) -> None:
    assert type_of(value) == name


def test_a_parameter_that_was_never_reported_has_the_type_that_is_wanted() -> None:
    row = ParameterRowJson.of(ParameterView("max_speed", None, 0.5))

    assert (row.value, row.type, row.wanted) == (None, "double", 0.5)


def test_an_array_is_a_list_and_keeps_its_types() -> None:
    row = ParameterRowJson.of(ParameterView("limits", (1.0, 2.0), None))

    assert '"value":[1.0,2.0]' in row.model_dump_json()


@pytest.mark.parametrize(("value", "text"), [(True, "true"), (1, "1"), (1.0, "1.0")])
def test_a_scalar_keeps_its_type(value: ParameterValue, text: str) -> None:
    assert (
        f'"value":{text},' in ParameterRowJson.of(ParameterView("x", value, None)).model_dump_json()
    )
