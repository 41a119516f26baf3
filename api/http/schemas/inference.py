"""Posted models and facts, and the inferred states."""

from collections.abc import Mapping
from typing import Any

from pydantic import ConfigDict, Field, model_validator

from api.http.schemas.base import MAX_MODEL_BYTES, Body, FindingJson, Json, StateAndModeJson
from api.http.schemas.parts import ActualJson
from api.http.schemas.sent_values import SentParameter, split_label
from domain.findings import Finding
from domain.parts.mode_settings import ModeSettings, OnFailure
from domain.parts.system_model import NodeModel, SystemModel
from domain.state_and_mode import ModeName
from domain.timebase import to_seconds


def _or_label(schema: dict[str, Any]) -> None:
    """Describe an object that can also be sent as a label."""
    described = dict(schema)
    schema.clear()
    schema["anyOf"] = [{"type": "string", "examples": ["active.FAST"]}, described]


class Labelled(Body):
    """An object with state and mode that can also be sent as a label: `active.FAST`."""

    model_config = ConfigDict(json_schema_extra=_or_label)

    @model_validator(mode="before")
    @classmethod
    def _from_label(cls, sent: object) -> object:
        return split_label(sent)


class TargetBody(Labelled):
    """A lifecycle state and, if any, a mode."""

    state: str
    mode: str | None = None


class ReportedNodeBody(Labelled):
    """Facts that a node is assumed to have reported."""

    state: str | None = Field(
        default=None, description="Label of a lifecycle state; omitted: never reported"
    )
    mode: str | None = Field(default=None, description="Reported mode; overrides the parameters")
    parameters: dict[str, SentParameter] = Field(
        default_factory=dict, description="As in ROS 2, 1 is an integer and 1.0 a double"
    )


class InferenceBody(Body):
    """Targets and facts, and their model."""

    model: str | None = Field(
        default=None, max_length=MAX_MODEL_BYTES, description="YAML; omitted: the loaded model"
    )
    targets: dict[str, TargetBody | None] = Field(default_factory=dict)
    nodes: dict[str, ReportedNodeBody | None] = Field(default_factory=dict)


class DeviationJson(Json):
    """A part that deviates from its target."""

    part: str
    target: StateAndModeJson
    actual: StateAndModeJson


class InferenceJson(Json):
    """Inferred states of all parts of the model, and deviations."""

    parts: dict[str, ActualJson]
    deviations: list[DeviationJson]


class ModelCheckJson(Json):
    """Errors and warnings about a model."""

    valid: bool
    findings: list[FindingJson]

    @classmethod
    def of(cls, findings: tuple[Finding, ...]) -> "ModelCheckJson":
        """Show `findings`."""
        valid = all(finding.severity != "error" for finding in findings)
        return cls(valid=valid, findings=[FindingJson.of(finding) for finding in findings])


class RuleJson(Json):
    """The target that replaces `if_target` of a system while a part is in a given state."""

    name: str
    if_target: str
    if_part: tuple[str, str]
    new_target: str


class TransitionSettingsJson(Json):
    """How the parts of a system enter a mode."""

    after: dict[str, tuple[str, ...]] = Field(
        description="Parts that must be done before each part begins"
    )
    deadline_s: float | None = Field(description="Of the whole change")
    on_failure: OnFailure


class ModeSettingsJson(Json):
    """Settings of one mode, filled in from those of `__ALL__`."""

    requires: tuple[str, ...] = Field(description="Conditions of entering the mode")
    invariants: tuple[str, ...] = Field(description="Conditions of entering and staying")
    grace_s: float = Field(description="How long an invariant may be broken")
    fallback: str | None = Field(description="Mode that replaces this one when one is broken")
    transition: TransitionSettingsJson

    @classmethod
    def of(cls, settings: ModeSettings) -> "ModeSettingsJson":
        """Show `settings`."""
        transition = settings.transition
        deadline = transition.deadline
        return cls(
            requires=tuple(condition.text for condition in settings.requires),
            invariants=tuple(condition.text for condition in settings.invariants),
            grace_s=to_seconds(settings.grace),
            fallback=settings.fallback,
            transition=TransitionSettingsJson(
                after={part: tuple(before) for part, before in transition.after.items()},
                deadline_s=None if deadline is None else to_seconds(deadline),
                on_failure=transition.on_failure,
            ),
        )


def _settings_json(settings: Mapping[ModeName, ModeSettings]) -> dict[str, ModeSettingsJson]:
    return {mode: ModeSettingsJson.of(of_mode) for mode, of_mode in settings.items()}


class SystemModelJson(Json):
    """A system of the model."""

    parts: tuple[str, ...]
    modes: dict[str, dict[str, StateAndModeJson]] = Field(
        description="State and mode that each mode requires of its parts"
    )
    rules: list[RuleJson]
    mode_settings: dict[str, ModeSettingsJson]

    @classmethod
    def of(
        cls, system: SystemModel, settings: Mapping[ModeName, ModeSettings]
    ) -> "SystemModelJson":
        """Show `system` with the settings of its modes."""
        return cls(
            parts=system.parts,
            modes={
                mode: {part: StateAndModeJson.of(want) for part, want in wanted.items()}
                for mode, wanted in system.modes.items()
            },
            rules=[
                RuleJson(
                    name=rule.name,
                    if_target=rule.if_target.label,
                    if_part=(rule.if_part[0], rule.if_part[1].label),
                    new_target=rule.new_target.label,
                )
                for rule in system.rules
            ],
            mode_settings=_settings_json(settings),
        )


class NodeModelJson(Json):
    """A node of the model."""

    modes: dict[str, dict[str, Any]] = Field(description="Parameters that each mode sets")
    mode_settings: dict[str, ModeSettingsJson]

    @classmethod
    def of(cls, node: NodeModel, settings: Mapping[ModeName, ModeSettings]) -> "NodeModelJson":
        """Show `node` with the settings of its modes."""
        return cls(
            modes={mode: dict(values) for mode, values in node.modes.items()},
            mode_settings=_settings_json(settings),
        )


class ModelJson(Json):
    """The model of the robot, with warnings."""

    systems: dict[str, SystemModelJson]
    nodes: dict[str, NodeModelJson]
    warnings: list[FindingJson]
