"""The link, against a small server that says what a test tells it to."""

import asyncio
import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from http import HTTPStatus
from urllib.parse import urlsplit

import pytest
from websockets.asyncio.server import ServerConnection, serve
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from api.cli.monitor.store import Json
from api.cli.monitor.view import Level
from api.cli.monitor.watch import Watch
from api.client import link as link_module
from api.client.address import Address
from api.client.link import Link
from api.client.outcomes import NoAnswerError, ServiceProblemError
from tests.support.monitor import (
    after,
    event,
    frame,
    hello,
    hold,
    named,
    part,
    stop,
    system,
    system_state,
)
from tests.support.waiting import until

FIRST = frame(
    parts=named("name", system("robot", "arm"), part("arm")),
    signals={},
    task=None,
    holds={},
    emergency_stop=stop(),
)


class Service:
    """Answers like Pilothouse, as far as the monitor asks."""

    def __init__(self) -> None:
        self.answers: dict[str, tuple[int, Json]] = {"/system_state": (200, system_state())}
        self.handshake: tuple[int, Json] | None = None
        """With what the stream is refused; None: it is not."""
        self.begin: list[Json] = [hello(), FIRST]
        """What each stream begins with."""
        self.streams: list[ServerConnection] = []
        self.asked: list[str] = []
        self.tokens: set[str | None] = set()

    async def say(self, *frames: Json) -> None:
        """Send frames over the newest stream."""
        for each in frames:
            await self.streams[-1].send(json.dumps(each))

    def request(self, _: ServerConnection, request: Request) -> Response | None:
        """Answer a request; None lets a handshake go on."""
        self.asked.append(request.path)
        self.tokens.add(request.headers.get("Authorization"))
        path = urlsplit(request.path).path
        answer = self.handshake if path == "/ws" else self.answers.get(path, (404, {}))
        if answer is None:
            return None
        body = json.dumps(answer[1]).encode()
        headers = Headers({"Content-Length": str(len(body)), "Connection": "close"})
        return Response(answer[0], HTTPStatus(answer[0]).phrase, headers, body)

    async def stream(self, connection: ServerConnection) -> None:
        """Begin a stream, and keep it open until the client goes."""
        self.streams.append(connection)
        await self.say(*self.begin)
        await connection.wait_closed()


@asynccontextmanager
async def linked(
    service: Service, token: str | None = None, topics: tuple[str, ...] = ()
) -> AsyncIterator[Watch]:
    """Run a link to a service, and end it with the context."""
    async with serve(service.stream, "127.0.0.1", 0, process_request=service.request) as server:
        port = server.sockets[0].getsockname()[1]
        address = Address.of(f"http://127.0.0.1:{port}", token)
        watch = Watch(address.url)
        run = asyncio.create_task(Link(address, watch, topics).run())
        try:
            yield watch
        finally:
            run.cancel()
            with suppress(asyncio.CancelledError):
                await run


async def run_to_its_end(service: Service) -> None:
    """Run a link that ends by itself."""
    async with serve(service.stream, "127.0.0.1", 0, process_request=service.request) as server:
        port = server.sockets[0].getsockname()[1]
        address = Address.of(f"http://127.0.0.1:{port}")
        await Link(address, Watch(address.url)).run()


@pytest.fixture(autouse=True)
def no_pauses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(link_module, "_RETRY_S", (0.0,))


async def test_the_first_frame_is_the_whole_picture() -> None:
    service = Service()
    async with linked(service) as watch:
        await until(lambda: watch.robot.is_whole)

    assert service.asked == ["/system_state", "/ws"]

    assert watch.robot.parts is not None
    assert list(watch.robot.parts) == ["robot", "arm"]
    assert watch.contact().level is Level.LIVE


async def test_the_token_goes_with_requests_and_with_the_handshake() -> None:
    service = Service()
    async with linked(service, "s3cret") as watch:
        await until(lambda: watch.robot.is_whole)

    assert service.tokens == {"Bearer s3cret"}


async def test_nothing_is_asked_for_when_holds_or_the_stop_change() -> None:
    service = Service()
    async with linked(service) as watch:
        await until(lambda: watch.robot.is_whole)
        held = {"operator": hold("operator", "loading")}
        await service.say(event(1, "hold operator set: loading"), frame(after(1), holds=held))

        await until(lambda: watch.robot.holds == held)

    assert service.asked == ["/system_state", "/ws"]


async def test_a_stream_that_ends_comes_back_and_goes_on_behind_the_last_event() -> None:
    service = Service()
    async with linked(service) as watch:
        await until(lambda: watch.robot.is_whole)
        await service.say(event(7), frame(after(1)))
        await until(lambda: watch.robot.at == after(1))

        await service.streams[-1].close(1012)
        await until(lambda: len(service.streams) == 2)
        await until(lambda: watch.contact().level is Level.LIVE)

    assert service.asked.count("/ws?after=7&epoch=one") == 1


async def test_the_topics_are_asked_for_again_after_a_loss() -> None:
    service = Service()
    async with linked(service, topics=("task", "vehicle")) as watch:
        await until(lambda: watch.robot.is_whole)
        await service.streams[-1].close(1012)
        await until(lambda: len(service.streams) == 2)

    assert [path for path in service.asked if path.startswith("/ws")] == [
        "/ws?topics=task,vehicle",
        "/ws?topics=task,vehicle&after=0&epoch=one",
    ]


async def test_another_service_at_the_same_place_is_gone_on_with() -> None:
    service = Service()
    async with linked(service) as watch:
        await until(lambda: watch.robot.is_whole)
        service.begin = [hello("two"), FIRST]

        await service.streams[-1].close()
        await until(lambda: watch.robot.epoch == "two" and watch.robot.is_whole)

    assert [note.words for note in watch.robot.notes] == [
        "the service was restarted: earlier tasks and holds are gone"
    ]


async def test_a_service_that_kept_its_events_is_asked_for_those_after_the_last_one() -> None:
    service = Service()
    service.begin = [hello("one", newest=40), FIRST]
    async with linked(service) as watch:
        await until(lambda: watch.robot.is_whole)
        service.begin = [hello("two", boot=2, newest=90), FIRST]

        for streams in (2, 3):
            await service.streams[-1].close()
            await until(lambda count=streams: len(service.streams) == count)

    assert [path for path in service.asked if path.startswith("/ws")][1:] == [
        "/ws?after=40&epoch=one",
        "/ws?after=40&epoch=two",
    ]


@pytest.mark.parametrize(
    ("code", "reason", "words"),
    [
        (1012, "", "the service stopped or is restarting"),
        (1013, "too slow", "the service closed the stream: too slow"),
        (1011, "", "the service closed the stream: 1011"),
    ],
)
async def test_why_a_stream_ended_is_told(
    monkeypatch: pytest.MonkeyPatch, code: int, reason: str, words: str
) -> None:
    service = Service()
    async with linked(service) as watch:
        await until(lambda: watch.robot.is_whole)
        # From now on nobody lets it in again.
        service.handshake = (503, {"detail": "not yet"})
        told: list[str] = []
        monkeypatch.setattr(watch, "lose", told.append)

        await service.streams[-1].close(code, reason)
        await until(lambda: bool(told))

    assert told[0] == words


async def test_a_connection_that_breaks_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    service = Service()
    async with linked(service) as watch:
        await until(lambda: watch.robot.is_whole)
        service.handshake = (503, {"detail": "not yet"})
        told: list[str] = []
        monkeypatch.setattr(watch, "lose", told.append)

        service.streams[-1].transport.abort()
        await until(lambda: bool(told))

    assert told[0] == "the connection was lost"


async def test_a_peer_that_is_silent_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(link_module, "SILENCE_S", 0.01)
    service = Service()
    async with linked(service) as watch:
        told: list[str] = []
        monkeypatch.setattr(watch, "lose", told.append)
        await until(lambda: len(service.streams) > 1)

    assert told[0] == "no frame for 0.01 s"


@pytest.mark.parametrize("status", [401, 403])
async def test_who_is_refused_does_not_try_again(status: int) -> None:
    service = Service()
    service.answers["/system_state"] = (status, {"detail": "a token is needed"})

    with pytest.raises(ServiceProblemError, match="a token is needed"):
        await run_to_its_end(service)

    assert service.asked == ["/system_state"]


async def test_who_has_no_token_is_told_where_it_belongs() -> None:
    service = Service()
    service.answers["/system_state"] = (401, {"detail": "a token is needed"})

    with pytest.raises(ServiceProblemError) as refused:
        await run_to_its_end(service)

    assert "PILOTHOUSE_TOKEN" in refused.value.problem["hint"]


async def test_a_stream_that_is_refused_is_not_tried_again_either() -> None:
    service = Service()
    service.handshake = (403, {"detail": "not from there"})

    with pytest.raises(ServiceProblemError, match="not from there"):
        await run_to_its_end(service)


async def test_a_stream_that_begins_with_a_refusal_ends_it() -> None:
    service = Service()
    service.begin = [{"type": "problem", "status": 401, "detail": "a token is needed"}]

    with pytest.raises(ServiceProblemError, match="a token is needed"):
        await run_to_its_end(service)


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        ((503, {"detail": "the model is being read"}), "the model is being read"),
        ((404, {}), "the server answered 404: is it Pilothouse?"),
        ((200, {}), "is not Pilothouse"),
    ],
)
async def test_an_answer_that_may_be_better_later_is_told_and_tried_again(
    answer: tuple[int, Json], words: str
) -> None:
    service = Service()
    service.answers["/system_state"] = answer
    async with linked(service) as watch:
        await until(lambda: service.asked.count("/system_state") > 1)
        assert words in watch.contact().why

        service.answers["/system_state"] = (200, system_state())
        await until(lambda: watch.robot.is_whole)


async def test_where_nobody_answers_that_is_told() -> None:
    async with serve(Service().stream, "127.0.0.1", 0) as server:
        port = server.sockets[0].getsockname()[1]
    address = Address.of(f"http://127.0.0.1:{port}")

    with pytest.raises(NoAnswerError, match="no service answers at"):
        await Link(address, Watch(address.url)).serve()
