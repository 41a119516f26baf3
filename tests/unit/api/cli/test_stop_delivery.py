"""A stop is tried until it is delivered."""

import threading
from collections.abc import Callable

import pytest

from api.cli import stop_delivery
from api.cli.stop_delivery import Delivery, deliver
from api.client.bare_request import Answer
from api.client.outcomes import NoAnswerError, NoConnectionError

ENGAGED = Answer(200, {"engaged": True}, is_volatile=False)
NOBODY = NoConnectionError("no service answers at http://robot: is it running?")


class Service:
    """Answers one try after the other; the last answer is that of all further tries."""

    def __init__(self, *answers: Answer | NoAnswerError | Callable[[], Answer]) -> None:
        self.answers = iter(answers)
        self.last = answers[-1]
        self.tries = 0
        self.said: list[str] = []
        self.now_s = 0.0

    def send(self, _: float) -> Answer:
        self.tries += 1
        answer = next(self.answers, self.last)
        if isinstance(answer, NoAnswerError):
            raise answer
        return answer if isinstance(answer, Answer) else answer()

    def pause(self, time_s: float) -> None:
        self.now_s += time_s

    def deliver(self, within_s: float = 10.0) -> Delivery:
        return deliver(self.send, within_s, self.said.append, lambda: self.now_s, self.pause)


def test_a_service_that_answers_is_asked_once() -> None:
    service = Service(ENGAGED)

    delivery = service.deliver()

    assert delivery.is_engaged
    assert (delivery.tries, service.tries, service.said) == (1, 1, [])


def test_a_service_that_comes_back_is_reached_and_each_try_is_told() -> None:
    service = Service(NOBODY, NOBODY, ENGAGED)

    assert service.deliver().is_engaged
    assert service.said == [f"try {number}: {NOBODY}; trying again" for number in (1, 2)]


def test_without_a_service_the_tries_end_at_the_deadline() -> None:
    service = Service(NOBODY)

    delivery = service.deliver(within_s=2.0)

    assert not delivery.is_engaged
    assert not delivery.is_open
    assert delivery.took_s == pytest.approx(2.0)
    assert service.said[-1] == f"try {delivery.tries}: {NOBODY}"


def test_a_request_that_was_sent_and_not_answered_may_have_arrived() -> None:
    assert Service(NoAnswerError("no answer from http://robot: timed out")).deliver(0.0).is_open


@pytest.mark.parametrize("status", [401, 403])
def test_a_rejection_is_not_tried_again(status: int) -> None:
    service = Service(Answer(status, {"detail": "no"}, is_volatile=False))

    delivery = service.deliver()

    assert not delivery.is_engaged
    assert delivery.answer is not None
    assert service.tries == 1


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (Answer(503, {"detail": "storage"}, is_volatile=False), "answered 503: storage"),
        (Answer(200, {"engaged": False}, is_volatile=False), "answered 200"),
        (Answer(404, {}, is_volatile=False), "answered 404"),
    ],
)
def test_any_other_answer_is_tried_again(answer: Answer, words: str) -> None:
    service = Service(answer, ENGAGED)

    assert service.deliver().is_engaged
    assert words in service.said[0]


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stop_delivery, "HANGS_S", 0.05)


@pytest.mark.usefixtures("impatient")
def test_a_try_that_hangs_is_left_and_does_not_hold_up_the_next() -> None:
    over = threading.Event()

    def hang() -> Answer:
        over.wait(10)
        return ENGAGED

    service = Service(hang, ENGAGED)
    try:
        delivery = service.deliver()
    finally:
        over.set()

    assert delivery.is_engaged
    assert delivery.tries == 2
    assert "no answer yet" in service.said[0]


@pytest.mark.usefixtures("impatient")
def test_the_late_answer_of_an_earlier_try_counts() -> None:
    first, second = threading.Event(), threading.Event()

    def late() -> Answer:
        second.wait(10)
        return ENGAGED

    def never() -> Answer:
        second.set()
        first.wait(10)
        return ENGAGED

    try:
        assert Service(late, never).deliver().is_engaged
    finally:
        first.set()
