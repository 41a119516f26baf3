"""The way from a thread of ROS to the event loop, with threads of the test's own."""

import asyncio
import logging
import threading
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import pytest

from service.ros.graph.crossing import MAX_UNANSWERED, POSTS_AT_ONCE, Crossing, Inbox, Server
from tests.support.waiting import until

Answer = Callable[[Any], Any]


@pytest.fixture
async def crossing() -> Crossing:
    made = Crossing()
    made.open()
    return made


async def elsewhere(call: Callable[..., object], *arguments: object) -> None:
    """Call something on another thread, while the event loop cannot run."""
    thread = threading.Thread(target=call, args=arguments)
    thread.start()
    thread.join()


def as_it_is(message: int) -> int:
    return message


# --- crossing ----------------------------------------------------------------------------------


async def test_what_is_posted_is_called_on_the_thread_of_the_loop(crossing: Crossing) -> None:
    called: list[tuple[str, int]] = []

    await elsewhere(crossing.post, lambda word: called.append((word, threading.get_ident())), "a")
    await until(lambda: bool(called))

    assert called == [("a", threading.get_ident())]


async def test_many_posts_wake_the_loop_once_and_are_called_in_order_in_several_passes(
    crossing: Crossing, monkeypatch: pytest.MonkeyPatch
) -> None:
    loop, woken, called, passes = asyncio.get_running_loop(), list[object](), list[int](), [0]
    call_soon = loop.call_soon_threadsafe

    def wake(callback: Callable[..., object]) -> None:
        woken.append(callback)
        call_soon(callback)

    monkeypatch.setattr(loop, "call_soon_threadsafe", wake)

    def post_all() -> None:
        for number in range(50):
            crossing.post(called.append, number)

    await elsewhere(post_all)
    while len(called) < 50:
        before = len(called)
        await asyncio.sleep(0)
        passes.append(len(called) - before)

    assert called == list(range(50))
    assert len(woken) == 1
    assert max(passes) <= POSTS_AT_ONCE


async def test_what_one_posted_call_raises_does_not_cost_the_next(crossing: Crossing) -> None:
    raised: list[object] = []
    asyncio.get_running_loop().set_exception_handler(
        lambda _loop, context: raised.append(context["exception"])
    )
    called: list[str] = []

    def fail() -> None:
        raise ValueError("broken")

    await elsewhere(crossing.post, fail)
    await elsewhere(crossing.post, called.append, "next")
    await until(lambda: bool(called))

    assert [str(error) for error in raised] == ["broken"]


async def test_what_waits_when_it_is_closed_is_not_called(crossing: Crossing) -> None:
    called: list[str] = []
    await elsewhere(crossing.post, called.append, "before")

    await crossing.close()
    await elsewhere(crossing.post, called.append, "after")
    await asyncio.sleep(0)
    await asyncio.sleep(0)

    assert called == []


def test_a_loop_that_is_closed_harms_nobody() -> None:
    crossing = Crossing()
    called: list[str] = []

    async def opened() -> None:
        crossing.open()

    asyncio.run(opened())
    crossing.post(called.append, "too late")

    assert called == []


def test_before_it_is_opened_nothing_crosses() -> None:
    called: list[str] = []

    Crossing().post(called.append, "too early")

    assert called == []


async def test_a_task_is_cancelled_when_it_is_closed(crossing: Crossing) -> None:
    ended: list[str] = []

    async def work() -> None:
        try:
            await asyncio.Event().wait()
        finally:
            ended.append("cancelled")

    crossing.own(work(), "work")
    await asyncio.sleep(0)

    await crossing.close()

    assert ended == ["cancelled"]


# --- inbox -------------------------------------------------------------------------------------


async def test_messages_come_in_order_and_one_by_one(crossing: Crossing) -> None:
    taken: list[int] = []
    inbox = Inbox(crossing, "/count", as_it_is, taken.append, 10)

    for number in range(3):
        await elsewhere(inbox.hear, number)
    await until(lambda: len(taken) == 3)
    await elsewhere(inbox.hear, 3)
    await until(lambda: len(taken) == 4)

    assert taken == [0, 1, 2, 3]


async def test_what_does_not_matter_does_not_come(crossing: Crossing) -> None:
    taken: list[int] = []
    inbox = Inbox(crossing, "/count", lambda n: n if n % 2 else None, taken.append, 10)

    for number in range(4):
        await elsewhere(inbox.hear, number)
    await until(lambda: len(taken) == 2)

    assert taken == [1, 3]


async def test_while_the_loop_is_busy_the_newest_are_kept(
    crossing: Crossing, caplog: pytest.LogCaptureFixture
) -> None:
    taken: list[int] = []
    inbox = Inbox(crossing, "/count", as_it_is, taken.append, 2)

    for number in range(5):
        await elsewhere(inbox.hear, number)
    await until(lambda: len(taken) == 2)

    assert taken == [3, 4]
    assert "/count: dropped 3 messages, the event loop was busy" in caplog.text


async def test_a_busy_loop_is_woken_once_for_all_messages(
    crossing: Crossing, monkeypatch: pytest.MonkeyPatch
) -> None:
    posted: list[object] = []
    taken: list[int] = []
    monkeypatch.setattr(crossing, "post", lambda call, *_: posted.append(call))
    inbox = Inbox(crossing, "/count", as_it_is, taken.append, 2)

    for number in range(100):
        await elsewhere(inbox.hear, number)

    assert len(posted) == 1


async def test_what_is_raised_over_one_message_does_not_cost_the_next(crossing: Crossing) -> None:
    raised: list[BaseException] = []
    asyncio.get_running_loop().set_exception_handler(
        lambda _loop, context: raised.append(context["exception"])
    )
    taken: list[float] = []
    inbox = Inbox(crossing, "/count", as_it_is, lambda n: taken.append(1 / n), 10)

    await elsewhere(inbox.hear, 0)
    await elsewhere(inbox.hear, 1)
    await until(lambda: bool(taken))

    assert taken == [1.0]
    assert [type(error) for error in raised] == [ZeroDivisionError]


async def test_a_message_that_cannot_be_read_is_told_once(
    crossing: Crossing, caplog: pytest.LogCaptureFixture
) -> None:
    taken: list[float] = []
    inbox = Inbox(crossing, "/count", lambda n: 1 / n, taken.append, 10)

    for number in (0, 0, 1):
        await elsewhere(inbox.hear, number)
    await until(lambda: bool(taken))

    assert taken == [1.0]
    assert [record.getMessage() for record in caplog.records] == [
        "/count: messages are dropped; the first one because of:"
    ]


async def test_what_was_heard_is_not_taken_after_it_is_closed(crossing: Crossing) -> None:
    taken: list[int] = []
    inbox = Inbox(crossing, "/count", as_it_is, taken.append, 10)
    await elsewhere(inbox.hear, 1)
    # One pass of the loop, in which it is handed out but not yet taken.
    await asyncio.sleep(0)

    await crossing.close()
    await asyncio.sleep(0)

    assert taken == []


# --- server ------------------------------------------------------------------------------------


class Word:
    """A request or a response with one field."""

    types: ClassVar = {"word": "string"}

    def __init__(self, word: str = "") -> None:
        self.word = word

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        return dict(cls.types)


class FakeService:
    """Sends what its callback returns, as a service of rclpy does.

    Args:
        callback: Takes a request and an empty response.
    """

    def __init__(self, callback: Callable[[Word, Word], Word]) -> None:
        self._callback = callback
        self.sent: list[tuple[str, int]] = []
        self.client_is_gone = False
        self.make_request: type[Word] = Word

    def send_response(self, response: Word, header: int) -> None:
        if self.client_is_gone:
            raise RuntimeError("there is no such client")
        self.sent.append((response.word, header))

    def hear(self, word: str, header: int) -> None:
        """Take a request, as rclpy's executor does."""
        response = self._callback(self.make_request(word), Word())
        self.send_response(response, header)


def served(crossing: Crossing, answer: Answer) -> FakeService:
    server = Server(crossing, "/echo", Word, answer, lambda work, *given: work(*given))
    service = FakeService(server.accept)
    server.attach(service)
    return service


async def echo(request: Mapping[str, Any]) -> Mapping[str, Any]:
    return {"word": f"{request['word']}!"}


async def test_a_request_is_answered_when_the_answer_is_there(crossing: Crossing) -> None:
    release = asyncio.Event()

    async def answer(request: dict[str, Any]) -> dict[str, Any]:
        if request["word"] == "slow":
            await release.wait()
        return {"word": f"{request['word']} done"}

    service = served(crossing, answer)
    await elsewhere(service.hear, "slow", 1)
    await elsewhere(service.hear, "quick", 2)
    await until(lambda: bool(service.sent))
    assert service.sent == [("quick done", 2)]

    release.set()
    await until(lambda: len(service.sent) == 2)

    assert service.sent == [("quick done", 2), ("slow done", 1)]


async def test_more_than_can_wait_are_refused_until_there_is_room(
    crossing: Crossing, caplog: pytest.LogCaptureFixture
) -> None:
    release = asyncio.Event()

    async def answer(_request: object) -> dict[str, Any]:
        await release.wait()
        return {"word": "done"}

    service = served(crossing, answer)
    for number in range(MAX_UNANSWERED + 2):
        await elsewhere(service.hear, "go", number)
    assert service.sent == [("", MAX_UNANSWERED), ("", MAX_UNANSWERED + 1)]
    assert len(caplog.records) == 1

    release.set()
    await until(lambda: len(service.sent) == MAX_UNANSWERED + 2)
    await elsewhere(service.hear, "go", -1)
    await until(lambda: service.sent[-1] == ("done", -1))


@pytest.mark.parametrize("given", [{"word": 1}, {"wrd": "a"}, None])
async def test_an_answer_that_is_no_response_leaves_it_empty(
    crossing: Crossing, caplog: pytest.LogCaptureFixture, given: object
) -> None:
    async def answer(_request: object) -> object:
        return given

    service = served(crossing, answer)
    await elsewhere(service.hear, "go", 1)
    await until(lambda: bool(service.sent))

    assert service.sent == [("", 1)]
    assert "/echo: a request gets an empty response" in caplog.text


async def test_a_large_request_is_read_on_the_thread_that_receives_it(
    crossing: Crossing,
) -> None:
    threads: list[threading.Thread] = []

    class Watched(Word):
        @classmethod
        def get_fields_and_field_types(cls) -> dict[str, str]:
            threads.append(threading.current_thread())
            return super().get_fields_and_field_types()

    service = served(crossing, echo)
    service.make_request = Watched
    await elsewhere(service.hear, "go", 1)
    await until(lambda: bool(service.sent))

    assert service.sent == [("go!", 1)]
    assert threading.main_thread() not in threads


async def test_an_answer_to_nobody_is_no_fault(
    crossing: Crossing, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO)
    service = served(crossing, echo)
    service.client_is_gone = True
    await elsewhere(service.hear, "go", 1)
    await until(lambda: "could not send a response: there is no such client" in caplog.text)

    service.client_is_gone = False
    await elsewhere(service.hear, "again", 2)
    await until(lambda: bool(service.sent))

    assert service.sent == [("again!", 2)]


async def test_a_request_that_comes_before_the_service_is_made_waits_for_it(
    crossing: Crossing,
) -> None:
    server = Server(crossing, "/echo", Word, echo, lambda work, *given: work(*given))
    service = FakeService(server.accept)
    hearing = threading.Thread(target=service.hear, args=("early", 1))
    hearing.start()
    assert hearing.is_alive()

    server.attach(service)
    hearing.join()
    await until(lambda: bool(service.sent))

    assert service.sent == [("early!", 1)]


async def test_what_is_answered_when_it_is_closed_is_cancelled(crossing: Crossing) -> None:
    async def answer(_request: object) -> dict[str, Any]:
        await asyncio.Event().wait()
        return {}

    service = served(crossing, answer)
    await elsewhere(service.hear, "go", 1)
    await asyncio.sleep(0)
    await asyncio.sleep(0)

    await crossing.close()

    assert service.sent == []
