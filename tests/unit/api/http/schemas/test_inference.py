"""Models, targets and facts as clients see and send them."""

import pytest
from pydantic import ValidationError

from api.http.schemas.inference import InferenceBody, ModelCheckJson, NodeModelJson, SystemModelJson
from domain.findings import Finding
from domain.parts.system_model import Rule, SystemModel
from tests.support.models import ACTUATION, BASE, PERFORMANCE, SLOW, active, actuation_model


def test_a_warning_alone_leaves_a_model_valid() -> None:
    assert ModelCheckJson.of((Finding("warning", "ODD", "odd"),)).valid is True
    assert ModelCheckJson.of((Finding("error", "BAD", "bad"),)).valid is False


def test_a_system_is_shown_with_what_each_mode_wants_and_its_rules() -> None:
    system = actuation_model().systems[ACTUATION]
    rule = Rule("slow_down", active(PERFORMANCE), (BASE, active(SLOW)), active("MODERATE"))
    with_rule = SystemModel(system.name, system.modes, (rule,))

    shown = SystemModelJson.of(with_rule)

    assert shown.modes["PERFORMANCE"]["drive_base"].mode == "FAST"
    assert shown.rules[0].model_dump() == {
        "name": "slow_down",
        "if_target": "active.PERFORMANCE",
        "if_part": ("drive_base", "active.SLOW"),
        "new_target": "active.MODERATE",
    }


def test_a_node_is_shown_with_the_parameters_of_its_modes() -> None:
    shown = NodeModelJson.of(actuation_model().nodes[BASE])

    assert shown.modes["FAST"] == {"max_speed": 0.9, "controller": "MPC"}


def test_a_state_and_mode_may_be_sent_as_a_label() -> None:
    body = InferenceBody.model_validate({"targets": {"a": "active.FAST", "b": None}})

    target = body.targets["a"]
    assert target is not None
    assert (target.state, target.mode) == ("active", "FAST")
    assert body.targets["b"] is None


@pytest.mark.parametrize("sent", [{"a": 1}, {"a": ["active"]}, {"a": {"mode": "FAST"}}, "a"])
def test_anything_else_is_no_target(sent: object) -> None:
    with pytest.raises(ValidationError):
        InferenceBody.model_validate({"targets": sent})
