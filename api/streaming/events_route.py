"""`GET /events`: the event log, for clients that do not use the stream."""

from itertools import islice
from typing import Annotated

from fastapi import APIRouter, Query, Response

from api.http.list_answers import joined
from api.http.route_policy import Permission, policy
from api.http.schemas.stream import EventsJson
from api.streaming.stream_server import StreamServerDep
from domain.events.event import RecordedEvent
from service.event_log import EventLog, EventReader, Gap

router = APIRouter(tags=["events"])

MAX_EVENTS = 1_000
_DEFAULT_EVENTS = 100
_READ_AT_ONCE = 1_000


@router.get("/events", response_model=EventsJson)
@policy(Permission.OBSERVE)
async def get_events(
    server: StreamServerDep,
    after: Annotated[
        int | None, Query(ge=0, lt=2**63, description="Id of the last known event")
    ] = None,
    epoch: Annotated[str | None, Query(max_length=64, description="Epoch of that id")] = None,
    limit: Annotated[
        int, Query(ge=1, le=MAX_EVENTS, description="Most events to return")
    ] = _DEFAULT_EVENTS,
    kind: Annotated[
        str | None,
        Query(max_length=100, description="A kind as `change.failed`, or a prefix as `change`"),
    ] = None,
) -> Response:
    """Return events in order: those that follow `after`, or else the newest.

    Requested events that are no longer kept are listed in `gaps`; a gap without an end means that
    the service was restarted since.
    """
    log = server.supervisor.events
    gaps: list[Gap] = []
    if after is None:
        events = list(islice((e for e in log.newest_first() if _is_of(e, kind)), limit))[::-1]
    else:
        gaps, events = _following(log, after, epoch, limit, kind)
    encoder = server.encoder
    head = EventsJson(
        epoch=log.epoch, oldest=log.oldest, newest=log.newest, gaps=[], items=[]
    ).model_dump_json(exclude={"gaps", "items"})
    told = await joined(map(encoder.gap, gaps))
    items = await joined(map(encoder.event, events))
    content = f'{head[:-1]},"gaps":[{told}],"items":[{items}]}}'
    return Response(content, media_type="application/json")


def _following(
    log: EventLog, after: int, epoch: str | None, limit: int, kind: str | None
) -> tuple[list[Gap], list[RecordedEvent]]:
    """Return the gaps and at most `limit` events of `kind` after a cursor.

    The log is read without letting other tasks run, which takes 3 ms at most: so `newest` is
    consistent with the events that were read.

    Args:
        log: The event log.
        after: Id of the last known event.
        epoch: Epoch of that id; None: the current one.
        limit: Most events.
        kind: A kind or a prefix of kinds; None: all.
    """
    reader = EventReader(log, after, epoch)
    gaps: list[Gap] = []
    events: list[RecordedEvent] = []
    while len(events) < limit and (found := reader.take(_READ_AT_ONCE)):
        gaps += [item for item in found if isinstance(item, Gap)]
        events += [item for item in found if isinstance(item, RecordedEvent) and _is_of(item, kind)]
    return gaps, events[:limit]


def _is_of(event: RecordedEvent, kind: str | None) -> bool:
    return kind is None or event.kind == kind or event.kind.startswith(f"{kind}.")
