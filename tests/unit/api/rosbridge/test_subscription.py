import json

import pytest

from api.rosbridge.replies import PublishedTexts
from api.rosbridge.subscription import MAX_QUEUE, Pace, Subscription
from domain.timebase import seconds
from service.ros.interface.endpoints import OfferedTopic
from tests.support.rosbridge import MODE_EVENT, SYSTEM_STATE


class Ears:
    """Hears what a subscription puts at once, and how often it says that something waits."""

    def __init__(self, topic: OfferedTopic, *paces: Pace) -> None:
        self.put: list[str] = []
        self.expected = 0
        self.subscription = Subscription(
            topic, topic.name, PublishedTexts(), self.put.append, self._expect
        )
        for number, pace in enumerate(paces):
            self.subscription.want(number, pace)

    def _expect(self, _: Subscription) -> None:
        self.expected += 1

    def hear(self, *numbers: int) -> None:
        for number in numbers:
            self.subscription.hear({"number": number})

    def taken(self, at_s: float) -> list[int]:
        return numbers_in(self.subscription.take(seconds(at_s)))


def numbers_in(texts: list[str]) -> list[int]:
    return [json.loads(text)["msg"]["number"] for text in texts]


def test_events_are_put_at_once_and_none_is_lost() -> None:
    ears = Ears(MODE_EVENT, Pace())

    ears.hear(1, 2, 3)

    assert numbers_in(ears.put) == [1, 2, 3]
    assert ears.taken(0) == []


def test_of_the_state_the_newest_waits_for_who_is_slow() -> None:
    ears = Ears(SYSTEM_STATE, Pace())

    ears.hear(1, 2, 3)

    assert ears.put == []
    assert ears.expected == 3
    assert ears.taken(0) == [3]
    assert ears.taken(0) == []


def test_a_throttled_client_gets_the_newest_when_it_is_time() -> None:
    ears = Ears(SYSTEM_STATE, Pace(least=seconds(0.1)))

    ears.hear(1)
    assert ears.taken(1.0) == [1]
    ears.hear(2, 3)
    assert ears.taken(1.05) == []
    assert ears.taken(1.1) == [3]


def test_a_throttled_client_does_not_fall_behind_because_one_message_was_late() -> None:
    ears = Ears(SYSTEM_STATE, Pace(least=seconds(0.1)))
    times = [1.0, 1.12, 1.2, 1.3]

    came = []
    for number, at_s in enumerate(times):
        ears.hear(number)
        came += ears.taken(at_s)

    assert came == [0, 1, 2, 3]


def test_events_too_are_throttled_if_that_is_wanted() -> None:
    ears = Ears(MODE_EVENT, Pace(least=seconds(1)))

    ears.hear(1, 2)

    assert ears.put == []
    assert ears.taken(5) == [2]


def test_of_a_queue_the_oldest_goes_and_the_rest_comes_in_order() -> None:
    ears = Ears(MODE_EVENT, Pace(queue_length=2))

    ears.hear(1, 2, 3)

    assert ears.taken(0) == [2, 3]


def test_a_throttled_queue_is_sent_one_by_one() -> None:
    ears = Ears(SYSTEM_STATE, Pace(least=seconds(0.5), queue_length=5))
    ears.hear(1, 2, 3)

    assert [ears.taken(at_s) for at_s in (1, 1.4, 1.5, 2)] == [[1], [], [2], [3]]


def test_no_client_makes_a_queue_as_long_as_it_likes() -> None:
    ears = Ears(MODE_EVENT, Pace(queue_length=10**9))

    ears.hear(*range(MAX_QUEUE + 1))

    assert len(ears.taken(0)) == MAX_QUEUE


def test_several_wishes_are_met_by_the_least_throttle_and_the_longest_queue() -> None:
    ears = Ears(SYSTEM_STATE, Pace(seconds(1), 0), Pace(seconds(0.1), 3), Pace(seconds(2), 2))
    ears.hear(1, 2, 3)

    assert [ears.taken(at_s) for at_s in (5, 5.1, 5.2)] == [[1], [2], [3]]


def test_when_the_fullest_wish_goes_the_rest_is_met() -> None:
    ears = Ears(SYSTEM_STATE, Pace(), Pace(least=seconds(1)))

    assert ears.subscription.unwant(0)

    ears.hear(1)
    assert ears.taken(5) == [1]
    ears.hear(2)
    assert ears.taken(5.5) == []
    assert ears.taken(6) == [2]


def test_a_client_that_wants_more_now_need_not_wait_as_long_as_before() -> None:
    ears = Ears(SYSTEM_STATE, Pace(least=seconds(3_600)))
    ears.hear(1)
    ears.taken(1)

    ears.subscription.want(0, Pace())

    ears.hear(2)
    assert ears.taken(1.05) == [2]


@pytest.mark.parametrize(("wish", "gone"), [(0, 1), (None, 2)])
def test_one_wish_goes_by_its_id_and_all_without_one(wish: int | None, gone: int) -> None:
    ears = Ears(MODE_EVENT, Pace(), Pace())

    assert ears.subscription.unwant(wish) == gone

    assert ears.subscription.is_wanted is (gone == 1)


def test_a_wish_of_an_id_that_is_there_is_no_further_one() -> None:
    ears = Ears(MODE_EVENT)

    assert [ears.subscription.want("a", Pace()) for _ in range(2)] == [1, 0]


def test_a_wish_that_is_not_there_cannot_go() -> None:
    ears = Ears(MODE_EVENT, Pace())

    assert ears.subscription.unwant("another") == 0
    assert ears.subscription.is_wanted
