"""Systems and nodes as clients see them, and requests to them."""

from collections.abc import Iterable
from typing import Annotated, Literal, TypeAlias, cast

from pydantic import Field

from api.http.schemas.base import (
    BlockerJson,
    Body,
    Json,
    StateAndModeJson,
    Timestamp,
    timestamp_or_none,
)
from api.http.schemas.sent_values import SentParameter
from domain.findings import Blocker
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import ParameterValue, value_type
from domain.snapshot import Actual, Because, EffectiveTarget, ModeView, ParameterView, PartView
from service.clock import Clock

MAX_WAIT_FOR_S = 3_600.0

ParameterType: TypeAlias = Literal[
    "bool",
    "integer",
    "double",
    "string",
    "bool_array",
    "integer_array",
    "double_array",
    "string_array",
]
"""Labels of `rcl_interfaces/msg/ParameterType`."""

ParameterJson: TypeAlias = (
    bool | int | float | str | list[bool] | list[int] | list[float] | list[str]
)
"""A value of a parameter in JSON; as in ROS 2, 1 is an integer and 1.0 a double."""


class ActualJson(Json):
    """Actual state and mode of a part, and how they are known."""

    state: LifecycleState
    mode: str | None
    inferred: bool = Field(description="The state was inferred (systems) rather than reported")
    mode_inferred: bool = Field(description="The mode was inferred, from parts or parameters")
    undecidable: bool
    reason: str | None

    @classmethod
    def of(cls, actual: Actual) -> "ActualJson":
        """Show `actual`."""
        return cls(
            state=actual.state,
            mode=actual.mode,
            inferred=actual.inferred,
            mode_inferred=actual.mode_inferred,
            undecidable=actual.undecidable,
            reason=actual.reason,
        )


class EffectiveTargetJson(Json):
    """The target in force, and why it may differ from the requested one."""

    state: LifecycleState
    mode: str | None
    because: Because = Field(description="Who set it; each prevails over those before it")
    rule: str | None = Field(description="Name of the rule that set it; null: no rule did")
    reaction: str | None = Field(
        description="Name of the reaction that set it; null: no reaction did"
    )
    cause: int | None = Field(
        description="Id of the event that recorded why it differs from the requested one"
    )
    blockers: tuple[BlockerJson, ...] = Field(
        description="Why the requested target is not in force; empty: it is"
    )

    @classmethod
    def of(cls, target: EffectiveTarget, clock: Clock) -> "EffectiveTargetJson":
        """Show `target`."""
        return cls(
            state=target.state,
            mode=target.mode,
            because=target.because,
            rule=target.rule,
            reaction=target.reaction,
            cause=target.cause,
            blockers=tuple(BlockerJson.of(blocker, clock) for blocker in target.blockers),
        )


class PartJson(Json):
    """One system or node."""

    name: str
    kind: Literal["system", "node"]
    parts: tuple[str, ...] = Field(description="Parts of a system; empty for a node")
    target: StateAndModeJson | None = Field(description="Target that was requested")
    effective_target: EffectiveTargetJson | None = Field(description="Target in force")
    actual: ActualJson
    converged: bool = Field(
        description="Whether it and all its parts are where their effective targets say"
    )
    deviation_since_at: Timestamp | None
    deviation_reason: str | None = Field(
        description="Which part is not where its target says; null exactly while `converged`"
    )
    reachable: bool = Field(description="For a system: whether all its nodes are reachable")
    change: str | None = Field(description="Id of the change that drives this part")
    device: str | None = Field(
        description="Computer that owns this node; null: this one, or it is a system"
    )
    last_known: StateAndModeJson | None = Field(
        description="Where an unreachable node was when it was heard last; null: nothing is known"
    )

    @classmethod
    def of(cls, view: PartView, clock: Clock) -> "PartJson":
        """Show `view`."""
        effective = view.effective_target
        return cls(
            name=view.name,
            kind=view.kind,
            parts=view.parts,
            target=StateAndModeJson.of(view.target) if view.target else None,
            effective_target=EffectiveTargetJson.of(effective, clock) if effective else None,
            actual=ActualJson.of(view.actual),
            converged=view.converged,
            deviation_since_at=timestamp_or_none(clock, view.deviation_since),
            deviation_reason=view.deviation_reason,
            reachable=view.reachable,
            change=view.change,
            device=view.device,
            last_known=StateAndModeJson.of(view.last_known) if view.last_known else None,
        )


class PartsJson(Json):
    """Systems, or nodes."""

    items: list[PartJson]


class StateJson(Json):
    """The lifecycle state of a part."""

    state: LifecycleState
    inferred: bool
    target: str | None = Field(
        description="What the operator asked for, as a label", examples=["active.FAST"]
    )
    available_transitions: list[Transition] = Field(
        description="Transitions that would be accepted now and change something"
    )

    @classmethod
    def of(cls, view: PartView, available: tuple[Transition, ...]) -> "StateJson":
        """Show the state of `view`."""
        return cls(
            state=view.actual.state,
            inferred=view.actual.inferred,
            target=view.target.label if view.target else None,
            available_transitions=list(available),
        )


class StatesJson(Json):
    """The primary states of a part."""

    items: list[LifecycleState]


class ModeJson(Json):
    """The mode of a part."""

    mode: str | None
    inferred: bool
    target: str | None = Field(
        description="What the operator asked for, as a label", examples=["active.FAST"]
    )

    @classmethod
    def of(cls, view: PartView) -> "ModeJson":
        """Show the mode of `view`."""
        return cls(
            mode=view.actual.mode,
            inferred=view.actual.mode_inferred,
            target=view.target.label if view.target else None,
        )


class EnterableModeJson(Json):
    """One mode of a part, and what blocks it now."""

    mode: str
    can_enter: bool = Field(description="Whether a request for it would be accepted now")
    can_stay: bool | None = Field(
        description="Whether all its invariants hold; null: it is not the mode in force"
    )
    blockers: list[BlockerJson]
    requires: tuple[str, ...] = Field(description="Conditions of entering it")
    invariants: tuple[str, ...] = Field(
        description="Conditions of entering it and of staying in it"
    )

    @classmethod
    def of(cls, view: ModeView, clock: Clock) -> "EnterableModeJson":
        """Show `view`."""
        blockers = [BlockerJson.of(blocker, clock) for blocker in view.blockers]
        return cls(
            mode=view.mode,
            can_enter=view.can_enter,
            can_stay=view.can_stay,
            blockers=blockers,
            requires=view.requires,
            invariants=view.invariants,
        )


class ModesJson(Json):
    """All modes of a part."""

    items: list[EnterableModeJson]


class WhyJson(Json):
    """Where a part is, where it should be, and why it is not there."""

    actual: ActualJson
    target: StateAndModeJson | None = Field(description="Target that was requested")
    effective_target: EffectiveTargetJson | None = Field(description="Target in force")
    converged: bool
    blockers: list[BlockerJson] = Field(description="The nearest to the part first")

    @classmethod
    def of(cls, view: PartView, blockers: Iterable[Blocker], clock: Clock) -> "WhyJson":
        """Show why `view` is not where it should be."""
        shown = PartJson.of(view, clock)
        return cls(
            actual=shown.actual,
            target=shown.target,
            effective_target=shown.effective_target,
            converged=shown.converged,
            blockers=[BlockerJson.of(blocker, clock) for blocker in blockers],
        )


class ParameterRowJson(Json):
    """One parameter of a node."""

    name: str
    value: ParameterJson | None = Field(description="null: never reported")
    type: ParameterType | None = Field(description="Type as in ROS 2; null: unknown")
    wanted: ParameterJson | None = Field(
        description="Value that the target mode requires; null: it requires none"
    )

    @classmethod
    def of(cls, view: ParameterView) -> "ParameterRowJson":
        """Show `view`."""
        known = view.wanted if view.value is None else view.value
        return cls(
            name=view.name,
            value=None if view.value is None else shown(view.value),
            type=type_of(known),
            wanted=None if view.wanted is None else shown(view.wanted),
        )


class ParametersJson(Json):
    """The parameters of a node."""

    items: list[ParameterRowJson]


WaitFor: TypeAlias = Annotated[
    float | None,
    Field(
        ge=0,
        le=MAX_WAIT_FOR_S,
        allow_inf_nan=False,
        description="How long it may wait for what its modes require, s; null: it is rejected then",
    ),
]


class ModeBody(Body):
    """Bring a part into a mode."""

    # No maximum but that of the body: a mode of a model may have a name of any length.
    mode: str = Field(min_length=1, examples=["PERFORMANCE"])
    wait_for_s: WaitFor = None


class TransitionBody(Body):
    """Request a lifecycle transition of a part."""

    transition: Literal["configure", "activate", "deactivate", "cleanup", "shutdown"]
    wait_for_s: WaitFor = None


ParametersBody: TypeAlias = Annotated[
    dict[str, SentParameter], Field(min_length=1, examples=[{"max_speed": 0.4}])
]
"""Values by parameter name."""


def shown(value: ParameterValue) -> ParameterJson:
    """Return a value of a parameter as JSON."""
    return list(value) if isinstance(value, tuple) else value  # type: ignore[return-value]


def type_of(value: ParameterValue | None) -> ParameterType | None:
    """Return the ROS 2 type of a value; None: unknown, as for an empty array."""
    return None if value is None or value == () else cast("ParameterType", value_type(value))
