"""Scenarios for the simulation, and their results."""

from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import (
    AfterValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from api.http.schemas.base import MAX_MODEL_BYTES, BlockerJson, Body, Json
from api.http.schemas.health import MAX_SOURCE
from api.http.schemas.problem import Problem
from api.http.schemas.sent_values import SentParameter, SentSignalValue
from api.http.schemas.simulated import FaultName, VehicleFaultName
from api.http.schemas.tasks import TaskBody
from domain.conditions.condition import Condition
from domain.conditions.lexer import MAX_LENGTH, ConditionSyntaxError
from domain.errors import near_match, shortened
from domain.events.kinds import EVENTS

MAX_UNTIL_S = 86_400.0
MAX_SAMPLES = 20_000
MAX_STEPS = 10_000
MAX_READINGS = 5_000_000
"""Largest number of readings of all steps, including repetitions."""

Time = Annotated[float, Field(ge=0, le=MAX_UNTIL_S, allow_inf_nan=False)]

MAX_DEPTH = 32
"""Largest nesting of values that are compared or forwarded unchanged."""


def _checked_depth(value: Any) -> Any:  # noqa: ANN401
    """Return a value unchanged.

    Raises:
        ValueError: Objects and lists are nested deeper than `MAX_DEPTH`.
    """
    level = [value]
    for _ in range(MAX_DEPTH + 1):
        nested = [item for item in level if isinstance(item, dict | list)]
        if not nested:
            return value
        inners = (item.values() if isinstance(item, dict) else item for item in nested)
        level = [inner for items in inners for inner in items]
    raise ValueError(f"more than {MAX_DEPTH} levels of nested objects and lists")


class TimedStep(Body):
    """Something that happens at a time."""

    t_s: Time = Field(description="Seconds from the start of the simulation")


class ActingStep(TimedStep):
    """An action, which may be rejected."""

    refused: bool = Field(
        default=False, description="Expect a rejection; anything else is a difference"
    )


class ReadingStep(ActingStep):
    """Readings that arrive together, once or repeatedly."""

    reading: dict[str, SentSignalValue] = Field(min_length=1)
    repeat_hz: Annotated[float, Field(gt=0, le=1_000)] | None = None
    until_s: Time | None = Field(
        default=None, description="Time of the last repetition; default: the end"
    )
    stamp_offset_s: float | None = Field(
        default=None, ge=-1e9, le=1e9, description="Stamp minus current time; omitted: no stamp"
    )
    source: str = Field(default="api", min_length=1, max_length=MAX_SOURCE)

    @model_validator(mode="after")
    def _is_judged_once(self) -> Self:
        if self.refused and self.repeat_hz is not None:
            raise ValueError("a reading that is expected to be rejected cannot be repeated")
        return self

    def count(self, until_s: float) -> int:
        """Return how many times the readings arrive up to `until_s`."""
        if self.repeat_hz is None:
            return 1
        last = until_s if self.until_s is None else min(self.until_s, until_s)
        # A millionth of a period, so that a grid that ends on `until_s` is not cut by rounding.
        return max(0, int((last - self.t_s) * self.repeat_hz + 1e-6)) + 1


class TaskStep(ActingStep):
    """A task is submitted or, with null, the current one is canceled."""

    task: TaskBody | None


class AskedChange(Body):
    """A requested change of a part: a mode or a transition."""

    part: str
    mode: str | None = None
    transition: Literal["configure", "activate", "deactivate", "cleanup", "shutdown"] | None = None

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        if (self.mode is None) is (self.transition is None):
            raise ValueError("a change must have either a mode or a transition")
        return self


class ChangeStep(ActingStep):
    """A change of mode or state is requested."""

    change: AskedChange


class NodeStep(ActingStep):
    """A simulated node gets a fault, or its parameters are set from outside."""

    node: str
    fault: FaultName | None = None
    parameters: dict[str, SentParameter] | None = None

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        if (self.fault is None) is (self.parameters is None):
            raise ValueError("a node step must have either a fault or parameters")
        return self


class VehicleStep(ActingStep):
    """The simulated vehicle gets a fault: it reports no pose, or brakes weakly."""

    vehicle: VehicleFaultName


class AskedRequest(Body):
    """Any request of the HTTP interface."""

    method: Literal["GET", "POST", "PUT", "PATCH", "DELETE"]
    path: str = Field(pattern=r"^/", max_length=1_000, examples=["/holds/operator"])
    body: Annotated[Any, AfterValidator(_checked_depth)] = None


class RequestStep(ActingStep):
    """A request of the HTTP interface is sent."""

    request: AskedRequest


class ExpectStep(TimedStep):
    """The expected state at this time, after the preceding steps."""

    expect: Annotated[dict[str, Any], AfterValidator(_checked_depth)] = Field(
        min_length=1,
        description=(
            "Relevant members of a sample; `last_task`: the current task, or the one that ended"
            " last; `events`: number of events by kind. A number can be given by `above`, `below`,"
            " `at_least` and `at_most`, and a state with its mode as a label"
        ),
        examples=[{"system_state": {"state": "ERROR"}, "events": {"task.started": 1}}],
    )

    @model_validator(mode="after")
    def _counts_events(self) -> Self:
        events = self.expect.get("events", {})
        if not isinstance(events, dict):
            raise ValueError("events must be an object with a number for each kind of event")
        for kind in events:
            if kind not in EVENTS:
                # A number of 0 of what never happens would be met by every robot.
                near = near_match(str(kind), tuple(EVENTS))
                hint = f"; did you mean {near}?" if near else ""
                raise ValueError(f"there is no kind of event {shortened(str(kind))!r}{hint}")
        return self


class ConditionStep(TimedStep):
    """A condition that must be true at this time, after the preceding steps."""

    expect: str = Field(
        min_length=1,
        max_length=MAX_LENGTH,
        description="A condition, as guards of modes are written",
        examples=["battery_level >= 0.3 and not error.ESTOP"],
    )

    @field_validator("expect")
    @classmethod
    def _is_condition(cls, text: str) -> str:
        try:
            Condition.parse(text)
        except ConditionSyntaxError as error:
            told = {"column": error.column, "message": error.message}
            raise PydanticCustomError(
                "condition_syntax", "column {column}: {message}", told
            ) from error
        return text


_KINDS = ("reading", "task", "change", "node", "vehicle", "request", "expect")


def _kind_of(step: object) -> str | None:
    names = step if isinstance(step, dict) else getattr(type(step), "model_fields", {})
    kind = next((kind for kind in _KINDS if kind in names), None)
    if kind != "expect":
        return kind
    expected = step["expect"] if isinstance(step, dict) else getattr(step, "expect", None)
    return "condition" if isinstance(expected, str) else kind


AnyStep: TypeAlias = (
    ReadingStep
    | TaskStep
    | ChangeStep
    | NodeStep
    | VehicleStep
    | RequestStep
    | ExpectStep
    | ConditionStep
)
Step = Annotated[
    Annotated[ReadingStep, Tag("reading")]
    | Annotated[TaskStep, Tag("task")]
    | Annotated[ChangeStep, Tag("change")]
    | Annotated[NodeStep, Tag("node")]
    | Annotated[VehicleStep, Tag("vehicle")]
    | Annotated[RequestStep, Tag("request")]
    | Annotated[ExpectStep, Tag("expect")]
    | Annotated[ConditionStep, Tag("condition")],
    Discriminator(
        _kind_of,
        custom_error_type="unknown_step",
        custom_error_message=f"a step must have t_s and one of {', '.join(_KINDS)}",
    ),
]


def place_in_body(location: tuple[int | str, ...]) -> tuple[int | str, ...]:
    """Return the keys that lead to an error in a scenario.

    Args:
        location: Location from pydantic, which adds the kind of a step.
    """
    is_in_step = location[:1] == ("steps",) and len(location) > 2
    return (*location[:2], *location[3:]) if is_in_step else location


class SimulationBody(Body):
    """A scenario: a robot and timed steps."""

    model_config = ConfigDict(validate_by_name=True, validate_by_alias=True)

    title: str = Field(default="", max_length=1_000)
    model: str | None = Field(
        default=None, max_length=MAX_MODEL_BYTES, description="SMH as YAML; null: the loaded model"
    )
    robot: dict[str, Any] | None = Field(
        default=None, description="Keys of a robot file; null: the defaults"
    )
    begin: Literal["live"] | None = Field(
        default=None,
        alias="from",
        description=(
            "`live`: start with a copy of the live robot, which must be simulated, and have one"
            " computer"
        ),
    )
    until_s: Time
    sample_period_s: Annotated[float, Field(gt=0, le=MAX_UNTIL_S, allow_inf_nan=False)] = 1.0
    steps: list[Step] = Field(default_factory=list, max_length=MAX_STEPS)

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.begin is not None and (self.model is not None or self.robot is not None):
            raise ValueError("a copy of the live robot has its own model and settings")
        # Not an integer: for very short periods it is infinite.
        periods = self.until_s / self.sample_period_s
        if periods >= MAX_SAMPLES:
            message = f"{periods + 1:.0f} samples; at most {MAX_SAMPLES}: sample less often"
            raise ValueError(message)
        readings = sum(
            len(step.reading) * step.count(self.until_s)
            for step in self.steps
            if isinstance(step, ReadingStep)
        )
        if readings > MAX_READINGS:
            raise ValueError(f"{readings} readings; at most {MAX_READINGS}")
        return self


class RefusalJson(Json):
    """A step that was rejected."""

    step: int = Field(description="Its index in `steps`")
    t_s: float
    problem: Problem


class DifferenceJson(Json):
    """A member that differs from its expected value."""

    path: str = Field(examples=["task.status"])
    expected: Any
    seen: Any


class ExpectationJson(Json):
    """The result of one `expect` step, or of a step that was expected to be rejected."""

    step: int = Field(description="Its index in `steps`")
    t_s: float
    differences: list[DifferenceJson] = Field(description="Empty: everything is as expected")
    blockers: list[BlockerJson] = Field(
        default_factory=list, description="Why the expected condition is not true"
    )


class SampleJson(Json):
    """The robot at one time, with all that a complete frame has."""

    t_s: float
    system_state: dict[str, Any]
    parts: dict[str, Any]
    signals: dict[str, Any]
    errors: dict[str, Any] = Field(description="Those that are not normal, by name")
    reactions: dict[str, Any] = Field(description="All reactions, by name")
    task: dict[str, Any] | None = Field(description="The current task; null: there is none")
    vehicle: dict[str, Any]
    holds: dict[str, Any] = Field(description="By owner")
    emergency_stop: dict[str, Any]


class SimulationJson(Json):
    """The result of a scenario."""

    samples: list[SampleJson]
    events: list[dict[str, Any]]
    refusals: list[RefusalJson]
    expectations: list[ExpectationJson]
