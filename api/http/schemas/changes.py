"""Changes of state, mode and parameters as clients see them."""

from typing import Literal

from pydantic import Field

from api.http.schemas.base import (
    Json,
    Timestamp,
    seconds_or_none,
    timestamp,
    timestamp_or_none,
)
from api.http.schemas.parts import ParameterJson, shown
from domain.changes.request_check import describe_request
from domain.inputs import ChangeRequest, ParametersRequest
from domain.lifecycle import Transition
from domain.snapshot import ChangeStatus, ChangeView, Rollback, StepStatus, StepView
from service.clock import Clock

RequestJson = dict[str, str | dict[str, ParameterJson]]
"""The request: `{"mode": ...}`, `{"transition": ...}` or `{"parameters": {...}}`."""


class StepJson(Json):
    """One step of a change: one request to one node."""

    node: str
    action: Transition | Literal["set_parameters"]
    status: StepStatus
    started_at: Timestamp | None
    ended_at: Timestamp | None
    error: str | None
    stage: int = Field(description="From 0; the nodes of one stage may run side by side")
    after: list[str] = Field(
        description="The nodes that its node waits for, without those that these wait for"
    )
    expected_s: float | None = Field(
        description="Median of the last 20 times of this node and action, s; null: never done"
    )
    rollback: bool = Field(description="Takes its node back to where it was before the change")

    @classmethod
    def of(cls, view: StepView, clock: Clock) -> "StepJson":
        """Show `view`."""
        return cls(
            node=view.node,
            action=view.action,
            status=view.status,
            started_at=timestamp_or_none(clock, view.started_at),
            ended_at=timestamp_or_none(clock, view.ended_at),
            error=view.error,
            stage=view.stage,
            after=list(view.after),
            expected_s=seconds_or_none(view.expected),
            rollback=view.rollback,
        )


class ChangeJson(Json):
    """One change of state, mode or parameters."""

    id: str
    part: str
    request: RequestJson
    status: ChangeStatus
    reason: str | None
    steps: list[StepJson]
    started_at: Timestamp
    ended_at: Timestamp | None
    cause: int = Field(description="Id of the event that recorded the request")
    stage: int = Field(description="The highest stage of which a node has begun")
    deadline_at: Timestamp | None = Field(description="When the change as a whole times out")
    rollback: Rollback | None = Field(
        description="Whether all parts are back where they were; null: nothing was taken back"
    )

    @classmethod
    def of(cls, view: ChangeView, clock: Clock) -> "ChangeJson":
        """Show `view`."""
        return cls(
            id=view.id,
            part=view.part,
            request=shown_request(view.request),
            status=view.status,
            reason=view.reason,
            steps=[StepJson.of(step, clock) for step in view.steps],
            started_at=timestamp(clock, view.started_at),
            ended_at=timestamp_or_none(clock, view.ended_at),
            cause=view.cause,
            stage=view.stage,
            deadline_at=timestamp_or_none(clock, view.deadline_at),
            rollback=view.rollback,
        )


class ChangesJson(Json):
    """Changes, the newest first."""

    items: list[ChangeJson]


class PlanJson(Json):
    """The steps that a change would take now."""

    part: str
    request: RequestJson
    steps: list[StepJson]
    stages: int
    expected_s: float | None = Field(
        description="The longest way through all steps, s; null: a step was never done before"
    )


def shown_request(request: ChangeRequest) -> RequestJson:
    """Return a request as clients see it."""
    if isinstance(request, ParametersRequest):
        return {"parameters": {name: shown(value) for name, value in request.values.items()}}
    return {key: str(value) for key, value in describe_request(request).items()}
