"""The header that tells whether a request survives a restart."""

import httpx
import pytest
from fastapi import FastAPI, Request

from api.http.gate.durable import DurableHeader
from api.http.kept_requests import DURABLE, DURABLE_HEADER

app = FastAPI()
app.add_middleware(DurableHeader)


@app.put("/holds/{outcomes}")
async def put(outcomes: str, request: Request) -> None:
    request.scope[DURABLE].extend(outcome == "y" for outcome in outcomes.strip("-"))


@pytest.mark.parametrize(
    ("outcomes", "told"), [("y", "true"), ("n", "false"), ("yn", "false"), ("-", None)]
)
async def test_the_answer_says_whether_all_is_on_disk(outcomes: str, told: str | None) -> None:
    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://robot") as to:
        answer = await to.put(f"/holds/{outcomes}")

    assert answer.headers.get(DURABLE_HEADER) == told
