"""`GET /events` and the causes of an event, for clients that do not use the stream."""

from typing import Annotated

from fastapi import APIRouter, Path, Query, Response

from api.http.list_answers import joined, json_list
from api.http.route_policy import Permission, policy
from api.http.schemas.stream import CausesJson, EventsJson
from api.streaming.events_query import EventQueryDep
from api.streaming.stream_server import StreamServerDep

router = APIRouter(tags=["events"])


@router.get("/events", response_model=EventsJson)
@policy(Permission.OBSERVE)
async def get_events(
    server: StreamServerDep,
    query: EventQueryDep,
    epoch: Annotated[
        str | None, Query(max_length=64, description="Epoch of the id in `after`")
    ] = None,
) -> Response:
    """Return events in order: those that follow `after`, or else the newest.

    They reach back over restarts of the service if its runs are kept. Requested events that are not
    there are listed in `gaps`: they are no longer kept, or were lost when the service was killed. A
    gap without an end means that the run which `epoch` names is not kept.
    """
    found = await server.history.find(query, epoch)
    encoder = server.encoder
    head = EventsJson(
        epoch=server.history.log.epoch, oldest=found.oldest, newest=found.newest, gaps=[], items=[]
    ).model_dump_json(exclude={"gaps", "items"})
    told = await joined(map(encoder.gap, found.gaps))
    items = await joined(map(encoder.event, found.items))
    content = f'{head[:-1]},"gaps":[{told}],"items":[{items}]}}'
    return Response(content, media_type="application/json")


@router.get("/events/{event}/causes", response_model=CausesJson)
@policy(Permission.OBSERVE)
async def get_causes(
    event: Annotated[int, Path(ge=0, lt=2**63, description="Id of an event")],
    server: StreamServerDep,
) -> Response:
    """Return an event, its cause, the cause of that and so on: to a reading, a timer or a person.

    At most 100 events are returned. If the last one has a `cause`, there are more, or that event is
    no longer kept: ask for the causes of that id.
    """
    return await json_list(map(server.encoder.event, await server.history.causes(event)))
