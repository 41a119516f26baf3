"""Processes beside the one that is dealt with."""

from domain.computers import Incarnation
from domain.link.messages import Refused
from domain.link.processes import Others
from domain.link.terms import OTHER_MODEL, Refusal
from domain.timebase import seconds

A, B = Incarnation("a"), Incarnation("b")


def test_a_process_is_forgotten_once_it_is_silent() -> None:
    others = Others(seconds(1.5))
    others.meet(A, 0)
    others.meet(B, seconds(1)).heard_at = seconds(1)

    assert others.wake_at() == seconds(1.5)
    others.forget_silent(seconds(1.5))

    assert (A in others, B in others, len(others)) == (False, True, 1)
    others.forget(B)
    assert others.wake_at() is None


def test_those_that_are_refused_are_told_so() -> None:
    others = Others(seconds(1.5))
    others.meet(A, 0)
    others.meet(B, 0).refusal = Refusal(OTHER_MODEL, "it runs another model")

    assert others.refused() == (Refused(B, OTHER_MODEL, "it runs another model"),)


def test_of_many_processes_those_that_were_heard_last_are_remembered() -> None:
    others = Others(seconds(1.5))
    for number in range(100):
        others.meet(Incarnation(str(number)), number)

    assert [other.incarnation for other in others] == [str(number) for number in range(92, 100)]
