"""What a query for events may ask."""

from datetime import UTC, datetime
from typing import Annotated

import httpx
import pytest
from fastapi import FastAPI, Request
from fastapi.responses import JSONResponse

from api.streaming.events_query import EventQueryDep
from domain.errors import InvalidValueError
from service.storage.journal import EventQuery

app = FastAPI()
asked: list[EventQuery] = []


@app.get("/events")
async def get_events(query: Annotated[EventQuery, EventQueryDep.__metadata__[0]]) -> None:
    asked.append(query)


@app.exception_handler(InvalidValueError)
async def refuse(request: Request, error: InvalidValueError) -> JSONResponse:
    return JSONResponse(error.message, 422)


async def ask(**query: str) -> httpx.Response:
    transport = httpx.ASGITransport(app)
    async with httpx.AsyncClient(transport=transport, base_url="http://robot") as to:
        return await to.get("/events", params=query)


async def test_without_conditions_the_newest_hundred_are_wanted() -> None:
    await ask()

    assert asked[-1] == EventQuery(limit=100)


async def test_a_range_of_time_holds_the_whole_millisecond_that_is_shown() -> None:
    await ask(from_at="2026-05-04T14:00:00.250+02:00", to_at="2026-05-04T12:00:00.250Z")

    assert asked[-1].from_at == datetime(2026, 5, 4, 12, 0, 0, 250_000, UTC)
    assert asked[-1].to_at == datetime(2026, 5, 4, 12, 0, 0, 250_999, UTC)


async def test_nobody_is_an_actor_too() -> None:
    await ask(actor="")

    assert asked[-1].actor == ""


@pytest.mark.parametrize(
    ("query", "told"),
    [
        ({"from_at": "yesterday"}, "query from_at: no time 'yesterday'"),
        ({"to_at": "2026-05-04T12:00:00"}, "query to_at: a time needs an offset"),
        (
            {"from_at": "2026-05-04T12:00:01Z", "to_at": "2026-05-04T12:00:00Z"},
            "is later than to_at",
        ),
        ({"after": "9", "before": "3"}, "query after: 9 is above before 3"),
    ],
)
async def test_nonsense_is_refused_with_the_reason(query: dict[str, str], told: str) -> None:
    answer = await ask(**query)

    assert answer.status_code == 422
    assert told in answer.json()


@pytest.mark.parametrize("limit", ["0", "1001", "-1"])
async def test_the_number_of_events_is_bounded(limit: str) -> None:
    assert (await ask(limit=limit)).status_code == 422
