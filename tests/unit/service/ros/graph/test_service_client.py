"""Requests go to rclpy, and responses come back on the event loop."""

import asyncio
import threading
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from domain.errors import InvalidValueError
from service.ros.graph.crossing import Crossing
from service.ros.graph.sending import Turnstile
from service.ros.graph.service_client import ServiceClient
from tests.support.waiting import until


class Request:
    """A request with one field."""

    def __init__(self) -> None:
        self.name = ""

    def get_fields_and_field_types(self) -> dict[str, str]:
        return {"name": "string"}


class Asked:
    """A future of rclpy."""

    def __init__(self) -> None:
        self._listening = threading.Event()
        self._tell: Callable[[Any], None]
        self._response: object = None

    def add_done_callback(self, tell: Callable[[Any], None]) -> None:
        self._tell = tell
        self._listening.set()

    def result(self) -> object:
        return self._response

    def answer(self, response: object) -> None:
        self._response = response
        threading.Thread(target=self._work).start()

    def _work(self) -> None:
        self._listening.wait(5)
        self._tell(self)


class RclpyClient:
    """A client that notes what is asked, and on which thread."""

    service_name = "/open"

    def __init__(self) -> None:
        self.asked: list[tuple[str, Asked, threading.Thread]] = []
        self.pending: list[Asked] = []

    def service_is_ready(self) -> bool:
        return True

    def call_async(self, request: Request) -> Asked:
        asked = Asked()
        self.asked.append((request.name, asked, threading.current_thread()))
        self.pending.append(asked)
        return asked

    def remove_pending_request(self, asked: Asked) -> None:
        self.pending.remove(asked)


class World:
    """A client of ours, and what is below it."""

    def __init__(self) -> None:
        self.crossing = Crossing()
        self.crossing.open()
        self.below = RclpyClient()
        node = SimpleNamespace(count_services=lambda _: 2)
        kind = SimpleNamespace(Request=Request)
        self.client = ServiceClient(self.crossing, Turnstile(2), node, kind, self.below)

    async def asked(self) -> tuple[str, Asked, threading.Thread]:
        await until(lambda: bool(self.below.asked), 0.001)
        return self.below.asked[0]


@pytest.fixture
async def world() -> World:
    return World()


async def test_a_response_from_another_thread_is_returned(world: World) -> None:
    calling = asyncio.create_task(world.client.call({"name": "door"}, 5))
    name, asked, thread = await world.asked()
    assert (name, thread) == ("door", threading.current_thread())
    asked.answer("opened")

    assert await calling == "opened"
    assert world.below.pending == []


async def test_a_large_request_is_made_and_sent_on_another_thread(world: World) -> None:
    makers = []

    def make() -> dict[str, str]:
        makers.append(threading.current_thread())
        return {"name": "hall"}

    calling = asyncio.create_task(world.client.call_large(make, 5))
    name, asked, thread = await world.asked()
    assert name == "hall"
    assert thread is makers[0] is not threading.current_thread()
    asked.answer("opened")

    assert await calling == "opened"


async def test_without_a_response_the_request_is_forgotten(world: World) -> None:
    with pytest.raises(TimeoutError):
        await world.client.call({}, 0.01)
    assert world.below.pending == []


async def test_fields_that_do_not_fit_are_an_error(world: World) -> None:
    with pytest.raises(InvalidValueError):
        await world.client.call({"name": 7}, 1)
    with pytest.raises(InvalidValueError):
        await world.client.call_large(lambda: {"size": 7}, 1)


async def test_nothing_is_sent_and_no_server_is_seen_once_the_link_is_closed(world: World) -> None:
    assert (world.client.is_ready(), world.client.servers()) == (True, 2)
    await world.crossing.close()

    for ask in (world.client.call({}, 1), world.client.call_large(dict, 1)):
        with pytest.raises(TimeoutError, match="closed"):
            await ask
    assert (world.client.is_ready(), world.client.servers()) == (False, 0)
    assert world.below.asked == []
