import asyncio
from contextlib import AsyncExitStack

import pytest

from api.app import create_app
from api.rosbridge.clients import MAX_CLIENTS, RosbridgeClients, rosbridge_clients
from api.streaming.stream_server import stream_server
from tests.support.live_robot import make_supervisor
from tests.support.manual_clock import settle
from tests.support.rosbridge import Pipe, SmallInterface, make_bridge


@pytest.fixture
def interface() -> SmallInterface:
    return SmallInterface()


@pytest.fixture
def hub(interface: SmallInterface) -> RosbridgeClients:
    lobby = stream_server(create_app(make_supervisor(), allowed_hosts=[]))
    return RosbridgeClients(lambda: make_bridge(interface), lobby)


def test_all_who_ask_share_one_hub() -> None:
    app = create_app(make_supervisor(), allowed_hosts=[])

    assert rosbridge_clients(app) is rosbridge_clients(app)
    assert rosbridge_clients(app).lobby is stream_server(app)


async def test_messages_are_made_while_there_is_a_client(
    hub: RosbridgeClients, interface: SmallInterface
) -> None:
    async with hub.serve(Pipe()) as first:
        async with hub.serve(Pipe()) as second:
            await settle()
            assert (hub.clients, interface.running) == (2, 1)
            assert first is second
        await settle()
        assert (hub.clients, interface.running) == (1, 1)
    await settle()
    assert (hub.clients, interface.running) == (0, 0)


async def test_a_client_that_comes_right_after_the_last_one_went_is_served(
    hub: RosbridgeClients, interface: SmallInterface
) -> None:
    async with hub.serve(Pipe()):
        await settle()
    async with hub.serve(Pipe()):
        await settle()

        assert interface.running == 1


async def test_a_client_that_goes_at_once_leaves_what_is_made_to_the_next(
    hub: RosbridgeClients, interface: SmallInterface
) -> None:
    hasty = asyncio.create_task(hub.bridge())
    await asyncio.sleep(0)
    hasty.cancel()
    await asyncio.gather(hasty, return_exceptions=True)

    assert (await hub.bridge()).interface is interface


async def test_one_client_is_one_too_many(hub: RosbridgeClients) -> None:
    async with AsyncExitStack() as serving:
        for _ in range(MAX_CLIENTS):
            assert not hub.is_full
            await serving.enter_async_context(hub.serve(Pipe()))

        assert hub.is_full
    assert not hub.is_full


async def test_when_no_more_messages_can_be_made_all_clients_are_cut_off(
    hub: RosbridgeClients,
    interface: SmallInterface,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def fail() -> None:
        await asyncio.sleep(0)
        raise ZeroDivisionError

    monkeypatch.setattr(interface, "run", fail)
    pipe = Pipe()
    async with hub.serve(pipe):
        await settle()

        assert pipe.aborted
    assert "rosbridge failed" in caplog.text
