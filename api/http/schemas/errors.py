"""Errors of the robot and of its parts as clients see them."""

from pydantic import Field

from api.http.schemas.base import Body, Json, Timestamp
from api.http.schemas.sent_values import SentSignalValue
from domain.findings import Fact
from domain.inputs import MAX_SHELF
from domain.snapshot import ErrorState, Severity
from domain.timebase import to_seconds

MAX_MESSAGE = 500
"""Largest length of what was found, in characters."""

MAX_REASON = 500
"""Largest length of the reason why an error is shelved, in characters."""


class ErrorNameJson(Json):
    """Which error."""

    part: str | None = Field(description="null: the robot's own")
    error: str


class ErrorJson(Json):
    """One error of the robot or of a part."""

    error: str = Field(examples=["DEVIATES"])
    part: str | None = Field(description="null: the robot's own")
    severity: Severity = Field(description="`critical` and `fatal` put the robot into ERROR")
    state: ErrorState = Field(
        description=(
            "`active`, `acknowledged` and `latched` are on; `latched`: its cause is gone, and an"
            " operator has yet to acknowledge it; `returned`: it ended by itself, and nobody has"
            " acknowledged it; `pending`: raised unless the cause ends in time"
        )
    )
    shelved_until_at: Timestamp | None = Field(
        description="Until then it is not announced; null: it is not shelved"
    )
    shelved_because: str | None = Field(description="Why it is shelved")
    suppressed: bool = Field(description="The model silences it as things are now")
    chattering: bool = Field(description="It was raised or ended more than 5 times in 10 min")
    root_cause: bool = Field(description="No other error causes it")
    first_out: bool = Field(description="It was raised first since no error was on")
    caused_by: list[ErrorNameJson]
    roots: list[ErrorNameJson] = Field(description="The errors that it goes back to")
    message: str = Field(description="What was found; empty while it is normal")
    value: Fact
    threshold: Fact
    since_at: Timestamp | None = Field(
        description="When it was raised, or began to be pending; null: it is normal"
    )
    ended_at: Timestamp | None = Field(
        description="When its cause was gone; null: it is present, or that is not known"
    )
    count: int = Field(description="How often it was raised in this run of the service")
    hint: str | None = Field(description="What would help")


class ShelfBody(Body):
    """For how long an error is not announced, and why."""

    for_s: float = Field(
        gt=0, le=to_seconds(MAX_SHELF), allow_inf_nan=False, description="At most 8 h"
    )
    reason: str = Field(min_length=1, max_length=MAX_REASON, pattern=r"\S")


class ErrorReportBody(Body):
    """Whether an error is there, as somebody found."""

    active: bool = Field(description="false: it is over")
    message: str = Field(default="", max_length=MAX_MESSAGE, description="What was found")
    value: SentSignalValue | None = Field(default=None, description="What was measured, if any")


class ErrorsJson(Json):
    """Errors: first the robot's own, then those of the parts in the order of the model file."""

    items: list[ErrorJson]
