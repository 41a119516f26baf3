"""Posted models and facts, and the inferred states."""

from typing import Any

from pydantic import ConfigDict, Field, model_validator

from api.http.schemas.base import MAX_MODEL_BYTES, Body, FindingJson, Json, StateAndModeJson
from api.http.schemas.parts import ActualJson
from api.http.schemas.sent_values import SentParameter, split_label
from domain.findings import Finding
from domain.parts.system_model import NodeModel, SystemModel


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


class SystemModelJson(Json):
    """A system of the model."""

    parts: tuple[str, ...]
    modes: dict[str, dict[str, StateAndModeJson]] = Field(
        description="State and mode that each mode requires of its parts"
    )
    rules: list[RuleJson]

    @classmethod
    def of(cls, system: SystemModel) -> "SystemModelJson":
        """Show `system`."""
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
        )


class NodeModelJson(Json):
    """A node of the model."""

    modes: dict[str, dict[str, Any]] = Field(description="Parameters that each mode sets")

    @classmethod
    def of(cls, node: NodeModel) -> "NodeModelJson":
        """Show `node`."""
        return cls(modes={mode: dict(values) for mode, values in node.modes.items()})


class ModelJson(Json):
    """The model of the robot, with warnings."""

    systems: dict[str, SystemModelJson]
    nodes: dict[str, NodeModelJson]
    warnings: list[FindingJson]
