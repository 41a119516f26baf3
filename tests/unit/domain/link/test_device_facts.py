"""What of the words of a device the core is given."""

from collections.abc import Iterator

from domain.inputs import ErrorReport, NodeAnswer, NodeReport, Reading, Readings, SourceFault
from domain.lifecycle import LifecycleState
from domain.link.device_facts import DeviceFacts
from domain.link.messages import Told
from domain.timebase import seconds
from tests.support.linked_pair import DRIVE

S = LifecycleState
INACTIVE = NodeReport(DRIVE, S.INACTIVE, reachable=True)
ACTIVE = NodeReport(DRIVE, S.ACTIVE, reachable=True)


class Words:
    """The words of a device that is connected at 0 s with an inactive node."""

    def __init__(self, *told: Told) -> None:
        self.facts = DeviceFacts(seconds(1.5))
        self.facts.note([INACTIVE, *told], 0, is_complete=True)
        self.begun = list(self.facts.give_all(0))

    def change(self, *told: Told, at_s: float = 1) -> list[Told]:
        return list(self._take(told, at_s, is_complete=False))

    def all(self, *told: Told, at_s: float = 1) -> list[Told]:
        return list(self._take(told, at_s, is_complete=True))

    def _take(self, told: tuple[Told, ...], at_s: float, *, is_complete: bool) -> Iterator[Told]:
        return self.facts.take(told, seconds(at_s), is_complete=is_complete)


def load(value: float, stamp_s: float | None = None) -> Readings:
    stamp = None if stamp_s is None else seconds(stamp_s)
    return Readings((Reading("load", value, stamp),), "can")


def test_it_begins_with_everything() -> None:
    assert Words(load(0.1, 0)).begun == [INACTIVE, load(0.1, 0)]


def test_what_changes_is_given_as_it_was_told_also_if_it_says_nothing_new() -> None:
    words = Words()

    # The answer to a question of the core must arrive, whatever is known.
    assert words.change(INACTIVE, NodeAnswer(1, DRIVE, True)) == [
        INACTIVE,
        NodeAnswer(1, DRIVE, True),
    ]


def test_a_complete_report_gives_only_what_was_missed() -> None:
    words = Words()
    words.change(ACTIVE)

    assert words.all(ACTIVE) == []
    assert words.all(INACTIVE) == [NodeReport(DRIVE, S.INACTIVE)]
    assert words.all(INACTIVE) == []


def test_a_reading_is_not_repeated_since_it_would_look_fresh() -> None:
    words = Words(load(0.1, 0))

    assert words.all(INACTIVE, load(0.1, 0)) == []


def test_after_a_gap_readings_that_were_missed_are_given() -> None:
    words = Words(load(0.1, 0))
    words.facts.note_gap()

    assert words.all(INACTIVE, load(0.2, 3), at_s=3.5) == [load(0.2, 3)]
    assert words.all(INACTIVE, load(0.3, 4), at_s=4.5) == [], "there was no gap since"


def test_after_a_gap_a_reading_that_is_known_is_not_given_again() -> None:
    words = Words(load(0.1, 0))
    words.facts.note_gap()

    assert words.all(INACTIVE, load(0.1, 0.3), at_s=3.5) == [], "its age is only about right"


def test_after_a_gap_the_same_value_of_a_later_time_is_given() -> None:
    words = Words(load(0.1, 0))
    words.facts.note_gap()

    assert words.all(INACTIVE, load(0.1, 3), at_s=3.5) == [load(0.1, 3)]


def test_after_a_gap_faults_of_sources_and_errors_are_given_once() -> None:
    fault, error = SourceFault("load", "can", "no bus"), ErrorReport(DRIVE, "JAMMED", active=True)
    words = Words(fault)
    words.facts.note_gap()

    assert words.all(INACTIVE, fault, error) == [error]


def test_after_a_loss_everything_must_be_told_again() -> None:
    words = Words()
    gone = list(words.facts.give_unreachable([DRIVE], seconds(2)))
    words.facts.begin_anew()
    before = words.facts.is_complete
    words.facts.note([ACTIVE], seconds(3), is_complete=True)
    words.facts.note([INACTIVE], seconds(3), is_complete=False)

    assert gone == [NodeReport(DRIVE, reachable=False)]
    assert (before, words.facts.is_complete) == (False, True)
    assert list(words.facts.give_all(seconds(3))) == [INACTIVE]
