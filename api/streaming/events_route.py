"""`GET /events`: the log that the stream reads too, for clients that ask now and then."""

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
        int | None, Query(ge=0, lt=2**63, description="Id of the last event known")
    ] = None,
    epoch: Annotated[str | None, Query(max_length=64, description="Epoch of that id")] = None,
    limit: Annotated[
        int, Query(ge=1, le=MAX_EVENTS, description="At most so many")
    ] = _DEFAULT_EVENTS,
    kind: Annotated[
        str | None,
        Query(max_length=100, description="`change.failed`, or `change` for all that begin so"),
    ] = None,
) -> Response:
    """Return events in order: those that follow `after`, or else the newest.

    Events that were asked for and are not kept any more are told in `gaps`; one without an end
    means that the service was restarted since.
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
    """Read on behind a cursor until there are `limit` events of `kind`.

    It is one look at the log, without turns for others: it takes 3 ms at most, and `newest` so
    tells up to where it was read.
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
