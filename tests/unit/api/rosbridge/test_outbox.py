import json

import pytest

from api.rosbridge.outbox import MAX_CHARACTERS, MAX_WAITING, Outbox
from api.rosbridge.replies import PublishedTexts
from api.rosbridge.subscription import Pace, Subscription
from domain.timebase import seconds
from tests.support.rosbridge import SYSTEM_STATE

USUAL = Pace()


@pytest.fixture
def woken() -> list[bool]:
    return []


@pytest.fixture
def outbox(woken: list[bool]) -> Outbox:
    return Outbox(lambda: woken.append(True))


def subscribe(outbox: Outbox, pace: Pace = USUAL) -> Subscription:
    subscription = Subscription(
        SYSTEM_STATE, "/system_state", PublishedTexts(), outbox.put, outbox.expect
    )
    subscription.want(None, pace)
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


def test_what_is_not_due_yet_is_taken_when_it_is(outbox: Outbox) -> None:
    subscription = subscribe(outbox, Pace(least=seconds(0.1)))
    subscription.hear({"state": 1})
    assert len(outbox.take(0)) == 1
    subscription.hear({"state": 2})

    assert outbox.take(seconds(0.05)) == []
    assert len(outbox.take(seconds(0.1))) == 1


def test_subscriptions_in_which_nothing_waits_are_not_looked_at(
    outbox: Outbox, monkeypatch: pytest.MonkeyPatch
) -> None:
    silent, lively = subscribe(outbox), subscribe(outbox)
    silent.hear({"state": 1})
    outbox.take(0)
    monkeypatch.setattr(silent, "take", lambda _: pytest.fail("a silent one was looked at"))
    lively.hear({"state": 2})

    assert len(outbox.take(0)) == 1


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


def test_large_answers_that_nobody_takes_overflow_before_they_are_many(outbox: Outbox) -> None:
    large = "x" * (MAX_CHARACTERS // 4)
    for _ in range(4):
        outbox.put(large)
    assert not outbox.overflowed

    outbox.put("one too many")

    assert outbox.overflowed


def test_large_answers_that_are_taken_make_room_for_others(outbox: Outbox) -> None:
    large = "x" * (MAX_CHARACTERS // 4)
    for _ in range(10):
        outbox.put(large)
        assert outbox.take(0) == [large]

    assert not outbox.overflowed


def test_of_large_answers_one_is_taken_in_a_turn(outbox: Outbox) -> None:
    large = "x" * (MAX_CHARACTERS // 4)
    outbox.put(large)
    outbox.put(large)

    assert [len(outbox.take(0)), outbox.has_more] == [1, True]
