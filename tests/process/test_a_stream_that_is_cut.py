"""A client that is cut off again and again, also by kill -9 of the service, has the whole log."""

import asyncio
from pathlib import Path
from random import Random

import httpx
import pytest

from service.storage.journal import EventQuery
from service.storage.sqlite.recorded_log import RecordedLog
from tests.support.cut_client import CutClient
from tests.support.process import ServiceProcess, service

CUTS, LIVES = 50, 3


async def hold_and_release(http: httpx.AsyncClient, pause_s: float) -> None:
    """Make events, until the service is gone."""
    try:
        while True:
            await http.put("/holds/door", json={"reason": "open"})
            await http.delete("/holds/door")
            await asyncio.sleep(pause_s)
    except httpx.TransportError:
        return


async def live(process: ServiceProcess, client: CutClient, cuts: int) -> None:
    """Let a client be cut while things happen, and kill the service."""
    async with httpx.AsyncClient(base_url=process.url) as http:
        busy = asyncio.create_task(hold_and_release(http, 0.002))
        await client.follow(process.stream_url, cuts)
        process.kill()
        await busy


@pytest.mark.timeout(120)
async def test_whoever_resumes_by_id_has_exactly_the_log(tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    client = CutClient(Random(7))
    for life in range(LIVES):
        with service("--data", str(folder)) as process:
            await live(process, client, CUTS // LIVES + (life < CUTS % LIVES))
    with service("--data", str(folder)) as process:
        async with httpx.AsyncClient(base_url=process.url) as http:
            await http.put("/holds/door", json={"reason": "the end"})
            newest = (await http.get("/events?limit=1")).json()["newest"]
        await client.follow_to(process.stream_url, newest)

    assert client.cuts == CUTS
    log = {
        event.id: (event.epoch, event.kind, event.cause, event.words)
        for event in RecordedLog(folder).events(EventQuery(after=0, limit=10**6))
        if event.id <= newest
    }
    seen = {
        event["id"]: (event["epoch"], event["kind"], event["cause"], event["words"])
        for event in client.events
    }
    # What was told in the last moment before a kill may be missing on disk, and is told as a gap.
    assert {number: seen[number] for number in seen if number in log} == log
    missing = [number for number in range(1, newest + 1) if number not in log]
    told = {number for first, last in client.gaps for number in range(first, last + 1)}
    assert told <= set(missing)
    assert set(missing) == told | (seen.keys() - log.keys())
    assert len(client.gaps) == LIVES
