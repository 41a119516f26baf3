"""Messages of the stream, except those that it shares with HTTP."""

from typing import Any, Literal

from pydantic import ConfigDict, Field
from pydantic.json_schema import SkipJsonSchema

from api.http.schemas.base import Body, Json, Timestamp, left_out
from api.http.schemas.devices import DeviceJson, ThisDeviceJson
from api.http.schemas.errors import ErrorJson
from api.http.schemas.health import (
    EmergencyStopJson,
    ReadingBody,
    StreamedSignalJson,
    SystemStateJson,
)
from api.http.schemas.parts import PartJson
from api.http.schemas.problem import Problem
from api.http.schemas.reactions import ReactionJson
from api.http.schemas.tasks import HoldJson, TaskJson, VehicleJson

# Members with a default are never omitted.
_WHOLE = ConfigDict(json_schema_serialization_defaults_required=True)


class ReplayJson(Json):
    """A recorded robot that is shown again."""

    robot: str = Field(description="Its name")
    from_at: Timestamp = Field(description="Begin of what can be shown")
    to_at: Timestamp = Field(description="Its end")
    at: Timestamp = Field(description="The moment that is shown")
    speed: float = Field(description="How much faster than then")
    paused: bool
    fault: str | None = Field(description="Why it cannot go on; null: it can")


class HelloJson(Json):
    """The first message to a client."""

    model_config = _WHOLE

    type: Literal["hello"] = "hello"
    epoch: str = Field(description="Name of this run of the service; another one after a restart")
    boot: int = Field(description="Number of this run, from 1; 1 if nothing is kept over restarts")
    started_at: Timestamp = Field(
        description="Start of this run of the service; the next frame is complete"
    )
    model: str = Field(description="Name of the model file, without its folder; empty: not known")
    newest: int = Field(description="Id of the newest event: resume after it if none came since")
    topics: list[str] = Field(description="Topics that this client is subscribed to")
    period_s: float = Field(description="Time between two `state` frames")
    version: str = Field(description="Version of Pilothouse")
    page_version: str = Field(
        description="Version of the files of the page; a page of another one asks to be reloaded"
    )
    replay: ReplayJson | None = Field(
        default=None, description="How a recording of a robot is shown; null: it is a robot"
    )


class StateFrame(Json):
    """The robot at one moment; always with `system_state`, the rest if it has changed.

    It only describes frames for clients: the frames themselves are joined from members that are
    encoded once for all clients.
    """

    type: Literal["state"]
    seq: int = Field(description="Rises by one per published frame")
    at: Timestamp
    skipped: int = Field(description="Frames that this client missed before this one")
    system_state: SystemStateJson
    parts: dict[str, PartJson] | SkipJsonSchema[None] = Field(
        default=None,
        description="Systems and nodes that have changed; all of them in a full frame",
        json_schema_extra=left_out,
    )
    signals: dict[str, StreamedSignalJson] | SkipJsonSchema[None] = Field(
        default=None,
        description="Signals that have changed; all of them in a full frame",
        json_schema_extra=left_out,
    )
    errors: dict[str, ErrorJson] | SkipJsonSchema[None] = Field(
        default=None,
        description=(
            "Errors that have changed, by name: `BATTERY_LOW`, `drive_base.UNREACHABLE`; one that"
            " ended is told once more, as `normal`. In a full frame, all that are not normal, and"
            " those that ended in the last two minutes: who connects anew begins with none"
        ),
        json_schema_extra=left_out,
    )
    reactions: dict[str, ReactionJson] | SkipJsonSchema[None] = Field(
        default=None,
        description=(
            "Reactions that have changed, by name, such as `vehicle.LIMP`; all of them in a full"
            " frame"
        ),
        json_schema_extra=left_out,
    )
    devices: dict[str, DeviceJson] | SkipJsonSchema[None] = Field(
        default=None,
        description=(
            "The other computers of the robot that have changed; all of them in a full frame; left"
            " out: none has changed, or the robot has one computer"
        ),
        json_schema_extra=left_out,
    )
    this_device: ThisDeviceJson | SkipJsonSchema[None] = Field(
        default=None,
        description=(
            "The device that the service runs on, and whose word counts there; left out: as it was,"
            " or it is no device"
        ),
        json_schema_extra=left_out,
    )
    task: TaskJson | None = Field(
        default=None,
        description=(
            "The current task, or the one that ended last (then `ended_at` is set); null: there"
            " never was one; left out: as it was"
        ),
        json_schema_extra=left_out,
    )
    vehicle: VehicleJson | SkipJsonSchema[None] = Field(
        default=None, description="Left out: as it was", json_schema_extra=left_out
    )
    holds: dict[str, HoldJson] | SkipJsonSchema[None] = Field(
        default=None,
        description="All holds, by owner, the oldest first; left out: as they were",
        json_schema_extra=left_out,
    )
    emergency_stop: EmergencyStopJson | SkipJsonSchema[None] = Field(
        default=None, description="Left out: as it was", json_schema_extra=left_out
    )


class EventJson(Json):
    """A decision, or a fact that became known."""

    model_config = _WHOLE

    type: Literal["event"] = "event"
    epoch: str = Field(description="Run of the service in which it happened")
    id: int = Field(description="Rises with each event, also over restarts if runs are kept")
    at: Timestamp
    kind: str = Field(description="What happened", examples=["change.succeeded"])
    cause: int | None = Field(description="Id of the event that led to this one; null: outside")
    actor: str = Field(description="Who requested it; empty: nobody")
    data: dict[str, Any] = Field(description="Details; the members depend on `kind`")
    words: str = Field(description="What happened, in one sentence for an operator")
    notable: bool = Field(description="false: detail that a short list omits")


class GapJson(Json, serialize_by_alias=True):
    """Events that the client requested and that are not there: too old to be kept, or lost."""

    model_config = _WHOLE

    type: Literal["gap"] = "gap"
    first: int = Field(serialization_alias="from", description="Id of the first of them")
    last: int | None = Field(
        serialization_alias="to",
        description="Id of the last of them; null: unknown, of a run that is not kept",
    )
    epoch: str = Field(description="Epoch that the ids belong to")


class EventsJson(Json):
    """A piece of the event log, in order."""

    epoch: str = Field(description="Of this run of the service")
    oldest: int = Field(description="Id of the oldest event that is kept")
    newest: int = Field(description="Id of the newest event; 0 before the first")
    gaps: list[GapJson] = Field(description="Requested events that are not there")
    items: list[EventJson]


class CausesJson(Json):
    """An event, then its cause, the cause of that and so on."""

    items: list[EventJson]


class ReadingMessage(ReadingBody):
    """A reading from a client; it takes effect on arrival, and is answered only if rejected."""

    type: Literal["reading"]
    signal: str = Field(min_length=1, max_length=256)


class ResyncMessage(Body):
    """A client that wants a complete frame next, as after a loss of its own."""

    type: Literal["resync"]


class AuthMessage(Body):
    """Authentication; the first message of a client if the service was started with a token."""

    type: Literal["auth"]
    token: str = Field(min_length=1, description="The value of `PILOTHOUSE_TOKEN`")


class ProblemFrame(Problem):
    """What was wrong with a message or with the URL (RFC 9457, except for `type`)."""

    type: Literal["problem"]
