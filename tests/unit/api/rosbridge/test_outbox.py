import json

import pytest

from api.rosbridge.outbox import MAX_WAITING, Outbox
from api.rosbridge.replies import PublishedTexts
from api.rosbridge.subscription import Pace, Subscription
from tests.support.rosbridge import SYSTEM_STATE


@pytest.fixture
def woken() -> list[bool]:
    return []


@pytest.fixture
def outbox(woken: list[bool]) -> Outbox:
    return Outbox(lambda: woken.append(True))


def subscribe(outbox: Outbox) -> Subscription:
    subscription = Subscription(
        SYSTEM_STATE, "/system_state", PublishedTexts(), outbox.put, outbox.wake
    )
    subscription.want(None, Pace())
    outbox.add(subscription)
    return subscription


def test_answers_go_in_the_order_in_which_they_were_put(outbox: Outbox, woken: list[bool]) -> None:
    outbox.put("first")
    outbox.put("second")

    assert woken == [True, True]
    assert outbox.take(0) == ["first", "second"]
    assert outbox.take(0) == []


def test_the_state_comes_after_the_answers(outbox: Outbox) -> None:
    subscribe(outbox).hear({"state": 1})
    outbox.put("answer")

    answer, state = outbox.take(0)

    assert answer == "answer"
    assert json.loads(state)["msg"] == {"state": 1}


def test_a_subscription_that_was_removed_gives_nothing_more(outbox: Outbox) -> None:
    subscription = subscribe(outbox)
    subscription.hear({"state": 1})

    outbox.remove(subscription)

    assert outbox.take(0) == []


def test_many_answers_are_taken_in_some_turns(outbox: Outbox) -> None:
    for number in range(250):
        outbox.put(f"{number}")

    taken = []
    while outbox.has_more:
        taken.append(len(outbox.take(0)))

    assert taken == [100, 100, 50]


def test_an_outbox_that_nobody_empties_overflows_and_does_not_grow(outbox: Outbox) -> None:
    for _ in range(MAX_WAITING):
        outbox.put("answer")
    assert not outbox.overflowed

    outbox.put("one too many")

    assert outbox.overflowed
    while outbox.has_more:
        assert "one too many" not in outbox.take(0)
