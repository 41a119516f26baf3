"""What goes over the stream, apart from what it shares with requests."""

from typing import Any, Literal

from pydantic import ConfigDict, Field

from api.schemas.base import Json, Timestamp
from api.schemas.health import ReadingBody


class HelloJson(Json):
    """The first frame."""

    type: Literal["hello"] = "hello"
    epoch: str = Field(description="Of the event ids; another one after each restart")
    topics: list[str]
    period_s: float = Field(description="Time between two `state` frames")
    version: str


class EventJson(Json):
    """Something that was decided or that became known."""

    type: Literal["event"] = "event"
    epoch: str
    id: int = Field(description="Rises by one per event within an epoch")
    at: Timestamp
    kind: str = Field(examples=["change.succeeded"])
    cause: int | None = Field(description="The event that led to this one; null: from outside")
    actor: str = Field(description="Who asked for it; empty: nobody")
    data: dict[str, Any]


class GapJson(Json):
    """Events that the client asked for and that are not kept any more."""

    model_config = ConfigDict(serialize_by_alias=True, validate_by_name=True)

    type: Literal["gap"] = "gap"
    first: int = Field(alias="from")
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
    """A reading that a client sends over the stream."""

    type: Literal["reading"]
    signal: str = Field(min_length=1, max_length=256)
