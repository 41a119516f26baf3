"""Base classes of all messages of the interface, and values that several of them share.

`...Json` is what a client receives, made from a view of the core by `of`; `...Body` is what a
client sends. Field names contain their unit; times end in `_at`.
"""

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from domain.findings import Blocker, Fact, Finding
from domain.lifecycle import LifecycleState
from domain.state_and_mode import StateAndMode
from domain.timebase import Duration, Instant, to_seconds
from service.clock import Clock

Timestamp = Annotated[
    str, Field(json_schema_extra={"format": "date-time"}, examples=["2026-01-01T12:00:00.250Z"])
]
"""RFC 3339, UTC, with milliseconds."""

MAX_MODEL_BYTES = 16 * 1024 * 1024
"""Largest model in a body, in bytes, whatever the limits of the service; as for model files."""


class Json(BaseModel):
    """A message that a client receives."""

    # Built with the first of its kind, in 3 ms at most: the routes have validators of their own.
    model_config = ConfigDict(defer_build=True, extra="forbid", frozen=True)


class Body(BaseModel):
    """A message that a client sends; unknown fields and values of the wrong type are rejected."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


def left_out(schema: dict[str, Any]) -> None:
    """Describe a member that can be omitted, which differs from null."""
    del schema["default"]


def rfc3339(moment: datetime) -> str:
    """Return a moment in UTC as RFC 3339 with milliseconds and `Z`."""
    return moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")


def timestamp(clock: Clock, at: Instant) -> str:
    """Return an instant of `clock` as RFC 3339."""
    return rfc3339(clock.wall_time(at))


def timestamp_or_none(clock: Clock, at: Instant | None) -> str | None:
    """Return an instant of `clock` as RFC 3339; None stays None."""
    return None if at is None else rfc3339(clock.wall_time(at))


def seconds_or_none(duration: Duration | None) -> float | None:
    """Return a duration in seconds; None stays None."""
    return None if duration is None else to_seconds(duration)


class StateAndModeJson(Json):
    """A lifecycle state and, if any, a mode."""

    state: LifecycleState
    mode: str | None

    @classmethod
    def of(cls, pair: StateAndMode) -> "StateAndModeJson":
        """Show `pair`."""
        return cls(state=pair.state, mode=pair.mode)


class BlockerJson(Json):
    """One reason why a request is blocked, or why the robot is in ERROR."""

    code: str
    message: str
    path: tuple[str, ...] = Field(
        description="Parts from the requested one down to the cause; for an error, the signal"
    )
    value: Fact
    threshold: Fact
    since_at: Timestamp | None
    root_cause: bool
    refuses: bool = Field(
        description="Whether a request is rejected because of it; false: it is only shown"
    )
    causes: "list[BlockerJson]" = Field(description="What it follows from; empty: it is a cause")
    condition: str | None = Field(
        description="Text of the condition that is not true, if it is one"
    )

    @classmethod
    def of(cls, blocker: Blocker, clock: Clock) -> "BlockerJson":
        """Show `blocker`."""
        return cls(
            code=blocker.code,
            message=blocker.message,
            path=blocker.path,
            value=blocker.value,
            threshold=blocker.threshold,
            since_at=timestamp_or_none(clock, blocker.since),
            root_cause=blocker.root_cause,
            refuses=blocker.refuses,
            causes=[cls.of(cause, clock) for cause in blocker.causes],
            condition=blocker.condition,
        )


class FindingJson(Json):
    """One error or warning in a model."""

    severity: Literal["error", "warning"]
    code: str
    message: str
    line: int | None = Field(description="Line, from 1")
    column: int | None = Field(description="Column, from 1")
    part: str | None

    @classmethod
    def of(cls, finding: Finding) -> "FindingJson":
        """Show `finding`."""
        return cls(
            severity=finding.severity,
            code=finding.code,
            message=finding.message,
            line=finding.line,
            column=finding.column,
            part=finding.part,
        )
