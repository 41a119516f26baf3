"""What goes over the stream, apart from what it shares with requests."""

from typing import Any, Literal

from pydantic import ConfigDict, Field
from pydantic.json_schema import SkipJsonSchema

from api.http.schemas.base import Body, Json, Timestamp
from api.http.schemas.health import (
    EmergencyStopJson,
    ReadingBody,
    StreamedSignalJson,
    SystemStateJson,
)
from api.http.schemas.parts import PartJson
from api.http.schemas.problem import Problem
from api.http.schemas.tasks import HoldJson, TaskJson, VehicleJson

# No member with a value of its own is ever left out.
_WHOLE = ConfigDict(json_schema_serialization_defaults_required=True)


class HelloJson(Json):
    """The first message to a client."""

    model_config = _WHOLE

    type: Literal["hello"] = "hello"
    epoch: str = Field(description="Of the event ids; another one after each restart")
    started_at: Timestamp = Field(
        description="When this run of the service began; tasks and holds of earlier runs are gone"
    )
    topics: list[str] = Field(description="What this client gets")
    period_s: float = Field(description="Time between two `state` frames")
    version: str = Field(description="Of Pilothouse")


def _left_out(schema: dict[str, Any]) -> None:
    """Describe a member that may be left out, which is not the same as null."""
    del schema["default"]


class StateFrame(Json):
    """The robot at one moment; `system_state` is always there, the rest where it has changed.

    It describes frames for clients. They are not made from it: what several clients are sent is
    joined from members that are encoded once.
    """

    type: Literal["state"]
    seq: int = Field(description="Rises by one per published frame")
    at: Timestamp
    skipped: int = Field(description="Frames that this client missed before this one")
    system_state: SystemStateJson
    parts: dict[str, PartJson] | SkipJsonSchema[None] = Field(
        default=None,
        description="Systems and nodes that have changed; all of them in a full frame",
        json_schema_extra=_left_out,
    )
    signals: dict[str, StreamedSignalJson] | SkipJsonSchema[None] = Field(
        default=None,
        description="Signals that have changed; all of them in a full frame",
        json_schema_extra=_left_out,
    )
    task: TaskJson | None = Field(
        default=None,
        description=(
            "The current task, or the one that ended last (then `ended_at` is set); null: there"
            " never was one; left out: as it was"
        ),
        json_schema_extra=_left_out,
    )
    vehicle: VehicleJson | SkipJsonSchema[None] = Field(
        default=None, description="Left out: as it was", json_schema_extra=_left_out
    )
    holds: dict[str, HoldJson] | SkipJsonSchema[None] = Field(
        default=None,
        description="All holds, by owner, the oldest first; left out: as they were",
        json_schema_extra=_left_out,
    )
    emergency_stop: EmergencyStopJson | SkipJsonSchema[None] = Field(
        default=None, description="Left out: as it was", json_schema_extra=_left_out
    )


class EventJson(Json):
    """Something that was decided or that became known."""

    model_config = _WHOLE

    type: Literal["event"] = "event"
    epoch: str
    id: int = Field(description="Rises by one per event within an epoch")
    at: Timestamp
    kind: str = Field(description="What happened", examples=["change.succeeded"])
    cause: int | None = Field(description="The event that led to this one; null: from outside")
    actor: str = Field(description="Who asked for it; empty: nobody")
    data: dict[str, Any] = Field(description="What there is to tell of it; another for each kind")
    words: str = Field(description="What happened, as one sentence for an operator")
    notable: bool = Field(description="false: detail that a short list leaves out")


class GapJson(Json):
    """Events that the client asked for and that are not kept any more."""

    model_config = ConfigDict(**_WHOLE, serialize_by_alias=True, validate_by_name=True)

    type: Literal["gap"] = "gap"
    first: int = Field(alias="from", description="Id of the first of them")
    last: int | None = Field(
        alias="to", description="null: the service was restarted since, and nobody knows"
    )
    epoch: str = Field(description="Epoch that the ids belong to")


class EventsJson(Json):
    """A piece of the event log, in order."""

    epoch: str
    oldest: int = Field(description="Id of the oldest event that is kept")
    newest: int = Field(description="Id of the newest event; 0 before the first")
    gaps: list[GapJson] = Field(description="What was asked for and is not kept any more")
    items: list[EventJson]


class ReadingMessage(ReadingBody):
    """A reading that a client sends; it is decided on arrival, and answered only if it is bad."""

    type: Literal["reading"]
    signal: str = Field(min_length=1, max_length=256)


class ResyncMessage(Body):
    """A client that wants a complete frame next, as after a loss of its own."""

    type: Literal["resync"]


class AuthMessage(Body):
    """Who the client is; its first message where the service was started with a token."""

    type: Literal["auth"]
    token: str = Field(min_length=1, description="The value of `PILOTHOUSE_TOKEN`")


class ProblemFrame(Problem):
    """What was wrong with a message or with the address (RFC 9457, but for `type`)."""

    type: Literal["problem"]
