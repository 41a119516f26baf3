"""Which parameters of a node differ from those that its target mode requires."""

import pytest

from domain.health.drift import Drift, drifted_parameter
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parameters import Parameters
from domain.parts.parts import Parts
from domain.parts.system_model import NodeModel, SmhModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from tests.support.models import BASE, active, actuation_model, inactive

LIDAR = PartName("lidar")
SCAN = ModeName("SCAN")


def parts_with(
    target: StateAndMode | None, known: Parameters, model: SmhModel | None = None
) -> Parts:
    parts = Parts(model or actuation_model(), Outbox())
    node = next(iter(parts.model.nodes))
    parts.take_report(NodeReport(node, LifecycleState.ACTIVE, parameters=known), 0)
    if target is not None:
        parts.ask({node: target})
    return parts


@pytest.mark.parametrize(
    ("target", "known"),
    [
        (None, {"max_speed": 7.0}),
        (inactive(), {"max_speed": 7.0}),
        (active("FAST"), {"max_speed": 0.9, "controller": "MPC"}),
        (active("FAST"), {"max_speed": 0.9}),
        (active("FAST"), {"max_speed": 0.9, "color": "red"}),
        (active("FAST"), {}),
        (StateAndMode(LifecycleState.ACTIVE), {"max_speed": 0.1, "controller": "PID"}),
    ],
)
def test_what_the_target_requires_or_says_nothing_about_has_not_drifted(
    target: StateAndMode | None, known: Parameters
) -> None:
    assert drifted_parameter(parts_with(target, known), BASE) is None


def test_a_parameter_of_another_value_or_type_has_drifted() -> None:
    drift = drifted_parameter(parts_with(active("FAST"), {"max_speed": 0.4}), BASE)
    assert drift == Drift("max_speed is 0.4, FAST requires 0.9", 0.4, 0.9)
    typed = drifted_parameter(parts_with(active("FAST"), {"max_speed": 1}), BASE)
    assert typed is not None
    assert typed.value == 1


def test_active_without_a_mode_requires_the_default() -> None:
    target = StateAndMode(LifecycleState.ACTIVE)
    drift = drifted_parameter(parts_with(target, {"max_speed": 0.4}), BASE)
    assert drift is not None
    assert drift.message == f"max_speed is 0.4, {DEFAULT_MODE} requires 0.1"


def test_of_several_the_first_of_the_file_is_told_with_how_many_more() -> None:
    known: Parameters = {"controller": "PID", "max_speed": 0.4}
    drift = drifted_parameter(parts_with(active("FAST"), known), BASE)
    assert drift is not None
    assert drift.message == "max_speed is 0.4, FAST requires 0.9, and 1 more"


def test_lists_are_told_in_the_message_alone() -> None:
    modes = {DEFAULT_MODE: {"gains": (1.0, 2.0)}, SCAN: {"gains": (3.0, 4.0)}}
    model = SmhModel({LIDAR: NodeModel(LIDAR, modes)}, {})
    drift = drifted_parameter(parts_with(active(SCAN), {"gains": (1.0, 2.0)}, model), LIDAR)
    assert drift == Drift("gains is (1.0, 2.0), SCAN requires (3.0, 4.0)", None, None)
