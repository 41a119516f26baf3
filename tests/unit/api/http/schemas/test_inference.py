"""Models, targets and facts as clients see and send them."""

import pytest
from pydantic import ValidationError

from api.http.schemas.inference import InferenceBody, ModelCheckJson, NodeModelJson, SystemModelJson
from domain.conditions.condition import Condition
from domain.findings import Finding
from domain.parts.mode_settings import ModeSettings, OnFailure, TransitionSettings
from domain.parts.system_model import Rule, SystemModel
from domain.state_and_mode import DEFAULT_MODE
from domain.timebase import seconds
from tests.support.models import ACTUATION, ARM, BASE, PERFORMANCE, SLOW, active, actuation_model


def test_a_warning_alone_leaves_a_model_valid() -> None:
    assert ModelCheckJson.of((Finding("warning", "ODD", "odd"),)).valid is True
    assert ModelCheckJson.of((Finding("error", "BAD", "bad"),)).valid is False


def test_a_system_is_shown_with_what_each_mode_wants_and_its_rules() -> None:
    system = actuation_model().systems[ACTUATION]
    rule = Rule("slow_down", active(PERFORMANCE), (BASE, active(SLOW)), active("MODERATE"))
    with_rule = SystemModel(system.name, system.modes, (rule,))

    shown = SystemModelJson.of(with_rule, {})

    assert shown.modes["PERFORMANCE"]["drive_base"].mode == "FAST"
    assert shown.rules[0].model_dump() == {
        "name": "slow_down",
        "if_target": "active.PERFORMANCE",
        "if_part": ("drive_base", "active.SLOW"),
        "new_target": "active.MODERATE",
    }


def test_a_node_is_shown_with_the_parameters_of_its_modes() -> None:
    shown = NodeModelJson.of(actuation_model().nodes[BASE], {})

    assert shown.modes["FAST"] == {"max_speed": 0.9, "controller": "MPC"}


def test_a_part_is_shown_with_the_settings_of_its_modes_in_the_words_of_the_file() -> None:
    settings = ModeSettings(
        requires=(Condition("battery_level > 0.3"),),
        grace=seconds(0.5),
        fallback=SLOW,
        transition=TransitionSettings({BASE: (ARM,)}, seconds(20), OnFailure.ROLLBACK),
    )

    shown = SystemModelJson.of(
        actuation_model().systems[ACTUATION], {PERFORMANCE: settings, DEFAULT_MODE: ModeSettings()}
    )

    assert shown.mode_settings["PERFORMANCE"].model_dump() == {
        "requires": ("battery_level > 0.3",),
        "invariants": (),
        "grace_s": 0.5,
        "fallback": "SLOW",
        "transition": {
            "after": {"drive_base": ("manipulator",)},
            "deadline_s": 20.0,
            "on_failure": "rollback",
        },
    }
    usual = shown.mode_settings["__DEFAULT__"].transition
    assert (usual.after, usual.deadline_s, usual.on_failure) == ({}, None, "continue")


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
