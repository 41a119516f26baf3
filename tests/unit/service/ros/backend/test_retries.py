"""Requests that get lost, and what is done about it."""

import asyncio
from collections.abc import Callable

import pytest

from service.ros.backend.retries import MAX_CALLS, Seen, call_with_retries
from tests.support.manual_clock import ManualClock


class Node:
    """Somebody who is asked, hears only some of it, and shows what came of it."""

    def __init__(self, *seen: Seen, answers: Callable[[int], bool]) -> None:
        self.clock = ManualClock()
        self.asked_at: list[float] = []
        self.running = 0
        self._seen = list(seen)
        self._answers = answers

    async def ask(self) -> str:
        self.asked_at.append(self.clock.now() / 1e9)
        number = len(self.asked_at)
        self.running += 1
        try:
            if not self._answers(number):
                await asyncio.Event().wait()
            await self.clock.sleep_until(self.clock.now() + 10_000_000)
        finally:
            self.running -= 1
        return f"answer {number}"

    async def see(self) -> Seen:
        if not self._seen:
            raise TimeoutError
        return self._seen.pop(0)

    async def ask_again(self, for_s: float) -> str | None:
        """Return what was answered within a time; None: nothing."""
        asking = asyncio.create_task(
            call_with_retries(self.ask, self.see, "it is done", self.clock)
        )
        await self.clock.advance(for_s)
        answer = asking.result() if asking.done() else None
        asking.cancel()
        await asyncio.wait([asking])
        assert self.running == 0
        return answer


async def test_who_answers_is_asked_once() -> None:
    node = Node(answers=lambda number: True)

    assert await node.ask_again(for_s=1) == "answer 1"
    assert node.asked_at == [0.0]


async def test_a_request_that_was_not_heard_is_asked_again() -> None:
    node = Node(Seen.LOST, answers=lambda number: number == 2)

    assert await node.ask_again(for_s=1) == "answer 2"
    assert node.asked_at == [0.0, 0.6]


async def test_a_request_whose_answer_got_lost_is_done() -> None:
    node = Node(Seen.DONE, answers=lambda number: False)

    assert await node.ask_again(for_s=1) == "it is done"
    assert node.asked_at == [0.0]


@pytest.mark.parametrize("seen", [(), (Seen.UNCLEAR,) * 9], ids=["silent", "at it"])
async def test_who_is_at_it_is_waited_for(seen: tuple[Seen, ...]) -> None:
    node = Node(*seen, answers=lambda number: False)

    assert await node.ask_again(for_s=5) is None
    assert node.asked_at == [0.0]


async def test_it_is_not_asked_for_ever() -> None:
    node = Node(*(Seen.LOST,) * 9, answers=lambda number: False)

    assert await node.ask_again(for_s=10) is None
    assert len(node.asked_at) == MAX_CALLS


async def test_after_a_while_nothing_is_asked_again_though_it_is_seen_to_be_lost() -> None:
    node = Node(Seen.UNCLEAR, Seen.UNCLEAR, Seen.LOST, Seen.LOST, answers=lambda number: False)

    assert await node.ask_again(for_s=10) is None
    assert node.asked_at == [0.0]
