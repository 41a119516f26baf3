"""What is done for a client ends with it."""

import asyncio
import gc
import weakref
from contextlib import suppress

import pytest
from fastapi import Request
from starlette.requests import ClientDisconnect

from api.http.client_presence import while_connected
from domain.errors import UnknownPartError
from tests.support.going_client import GoingClient
from tests.support.http_robot import http_scope
from tests.support.manual_clock import settle


class Client(GoingClient):
    """Has asked for a frame."""

    def __init__(self) -> None:
        super().__init__()
        self.request = Request(http_scope("GET", "/frames"), self.receive)


class Work:
    """Takes until somebody ends it."""

    def __init__(self) -> None:
        self.may_end = asyncio.Event()
        self.is_given_up = False

    async def do(self) -> str:
        try:
            await self.may_end.wait()
        except asyncio.CancelledError:
            self.is_given_up = True
            raise
        return "done"


async def test_a_client_that_stays_gets_the_result() -> None:
    client, work = Client(), Work()
    answer = asyncio.create_task(while_connected(client.request, work.do()))
    await settle()

    work.may_end.set()

    assert await answer == "done"


async def test_work_for_a_client_that_has_gone_is_given_up() -> None:
    client, work = Client(), Work()
    answer = asyncio.create_task(while_connected(client.request, work.do()))
    await settle()

    client.gone.set()

    with pytest.raises(ClientDisconnect):
        await answer
    assert work.is_given_up


async def test_an_error_of_the_work_is_raised() -> None:
    async def fail() -> None:
        raise UnknownPartError("part", "base", ())

    with pytest.raises(UnknownPartError):
        await while_connected(Client().request, fail())


async def test_an_error_is_released_without_a_collection_of_garbage() -> None:
    seen: list[weakref.ref[Exception]] = []

    async def fail() -> None:
        error = UnknownPartError("part", "base", ())
        seen.append(weakref.ref(error))
        try:
            raise error
        finally:
            del error

    gc.disable()
    try:
        with suppress(UnknownPartError):
            await while_connected(Client().request, fail())
        # The loop holds its last callbacks for one more turn.
        await asyncio.sleep(0)
        assert seen[0]() is None
    finally:
        gc.enable()


async def test_a_service_that_ends_gives_up_the_work_and_the_watch() -> None:
    client, work = Client(), Work()
    before = asyncio.all_tasks()
    answer = asyncio.create_task(while_connected(client.request, work.do()))
    await settle()

    answer.cancel()
    await asyncio.gather(answer, return_exceptions=True)

    assert work.is_given_up
    assert asyncio.all_tasks() == before
