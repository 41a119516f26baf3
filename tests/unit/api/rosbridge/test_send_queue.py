import json

import pytest

from api.rosbridge.replies import PublishedTexts
from api.rosbridge.send_queue import MAX_CHARACTERS, MAX_WAITING, SendQueue
from api.rosbridge.subscription import Pace, Subscription
from domain.timebase import seconds
from tests.support.rosbridge import SYSTEM_STATE

USUAL = Pace()


@pytest.fixture
def woken() -> list[bool]:
    return []


@pytest.fixture
def queue(woken: list[bool]) -> SendQueue:
    return SendQueue(lambda: woken.append(True))


def subscribe(queue: SendQueue, pace: Pace = USUAL) -> Subscription:
    subscription = Subscription(
        SYSTEM_STATE, "/system_state", PublishedTexts(), queue.put, queue.expect
    )
    subscription.want(None, pace)
    return subscription


def test_answers_go_in_the_order_in_which_they_were_put(
    queue: SendQueue, woken: list[bool]
) -> None:
    queue.put("first")
    queue.put("second")

    assert woken == [True, True]
    assert queue.take(0) == ["first", "second"]
    assert queue.take(0) == []


def test_the_state_comes_after_the_answers(queue: SendQueue) -> None:
    subscribe(queue).hear({"state": 1})
    queue.put("answer")

    answer, state = queue.take(0)

    assert answer == "answer"
    assert json.loads(state)["msg"] == {"state": 1}


def test_what_is_not_due_yet_is_taken_when_it_is(queue: SendQueue) -> None:
    subscription = subscribe(queue, Pace(least=seconds(0.1)))
    subscription.hear({"state": 1})
    assert len(queue.take(0)) == 1
    subscription.hear({"state": 2})

    assert queue.take(seconds(0.05)) == []
    assert len(queue.take(seconds(0.1))) == 1


def test_subscriptions_in_which_nothing_waits_are_not_looked_at(
    queue: SendQueue, monkeypatch: pytest.MonkeyPatch
) -> None:
    silent, lively = subscribe(queue), subscribe(queue)
    silent.hear({"state": 1})
    queue.take(0)
    monkeypatch.setattr(silent, "take", lambda _: pytest.fail("a silent one was looked at"))
    lively.hear({"state": 2})

    assert len(queue.take(0)) == 1


def test_a_subscription_that_was_removed_gives_nothing_more(queue: SendQueue) -> None:
    subscription = subscribe(queue)
    subscription.hear({"state": 1})

    queue.remove(subscription)

    assert queue.take(0) == []


def test_many_answers_are_taken_in_some_turns(queue: SendQueue) -> None:
    for number in range(250):
        queue.put(f"{number}")

    taken = []
    while queue.has_more:
        taken.append(len(queue.take(0)))

    assert taken == [100, 100, 50]


def test_an_outbox_that_nobody_empties_overflows_and_does_not_grow(queue: SendQueue) -> None:
    for _ in range(MAX_WAITING):
        queue.put("answer")
    assert not queue.overflowed

    queue.put("one too many")

    assert queue.overflowed
    while queue.has_more:
        assert "one too many" not in queue.take(0)


def test_large_answers_that_nobody_takes_overflow_before_they_are_many(queue: SendQueue) -> None:
    large = "x" * (MAX_CHARACTERS // 4)
    for _ in range(4):
        queue.put(large)
    assert not queue.overflowed

    queue.put("one too many")

    assert queue.overflowed


def test_large_answers_that_are_taken_make_room_for_others(queue: SendQueue) -> None:
    large = "x" * (MAX_CHARACTERS // 4)
    for _ in range(10):
        queue.put(large)
        assert queue.take(0) == [large]

    assert not queue.overflowed


def test_of_large_answers_one_is_taken_in_a_turn(queue: SendQueue) -> None:
    large = "x" * (MAX_CHARACTERS // 4)
    queue.put(large)
    queue.put(large)

    assert [len(queue.take(0)), queue.has_more] == [1, True]
