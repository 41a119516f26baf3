"""Many deadlines, one of which is next."""

import pickle

import hypothesis.strategies as st
from hypothesis import given
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from domain.deadlines import Deadlines, SharedDeadlines


def test_without_a_deadline_nothing_is_next_and_nothing_is_due() -> None:
    deadlines: Deadlines[str] = Deadlines()
    assert deadlines.next() is None
    assert deadlines.pop_due(10) is None


def test_a_deadline_is_due_at_its_time_and_not_a_nanosecond_earlier() -> None:
    deadlines: Deadlines[str] = Deadlines()
    deadlines.set("arm", 10)
    assert deadlines.pop_due(9) is None
    assert deadlines.pop_due(10) == "arm"


def test_a_deadline_comes_once() -> None:
    deadlines: Deadlines[str] = Deadlines()
    deadlines.set("arm", 10)
    deadlines.pop_due(10)
    assert deadlines.pop_due(10) is None
    assert deadlines.next() is None


def test_equal_deadlines_come_in_the_order_in_which_they_were_set() -> None:
    """Not in the order of their keys: keys need no order at all."""
    deadlines: Deadlines[str] = Deadlines()
    for key in ("b", "c", "a"):
        deadlines.set(key, 10)
    assert [deadlines.pop_due(10) for _ in range(3)] == ["b", "c", "a"]


def test_a_deadline_that_is_set_again_counts_as_set_last() -> None:
    deadlines: Deadlines[str] = Deadlines()
    for key in ("a", "b", "a"):
        deadlines.set(key, 10)
    assert [deadlines.pop_due(10) for _ in range(3)] == ["b", "a", None]


def test_a_deadline_that_was_cleared_never_comes() -> None:
    deadlines: Deadlines[str] = Deadlines()
    deadlines.set("arm", 10)
    deadlines.set("base", 12)
    deadlines.clear("arm")
    deadlines.clear("tail")
    assert deadlines.next() == 12
    assert deadlines.pop_due(20) == "base"
    assert deadlines.pop_due(20) is None


def test_a_deadline_that_is_put_off_again_and_again_takes_no_memory() -> None:
    deadlines: Deadlines[str] = Deadlines()
    deadlines.set("arm", 1)
    for at in range(10_000):
        deadlines.set("base", 1_000_000 + at)
    assert len(pickle.dumps(deadlines)) < 10_000
    assert deadlines.pop_due(1) == "arm"
    assert deadlines.next() == 1_009_999


class AgainstASortedList(RuleBasedStateMachine):
    """Whatever is set, cleared and popped, it is as if all were sorted anew each time."""

    def __init__(self) -> None:
        super().__init__()
        self.deadlines: Deadlines[int] = Deadlines()
        self.expected: dict[int, tuple[int, int]] = {}
        self.count = 0

    @rule(key=st.integers(0, 4), at=st.integers(0, 20))
    def set(self, key: int, at: int) -> None:
        self.count += 1
        self.deadlines.set(key, at)
        self.expected[key] = (at, self.count)

    @rule(key=st.integers(0, 4))
    def clear(self, key: int) -> None:
        self.deadlines.clear(key)
        self.expected.pop(key, None)

    @rule(now=st.integers(0, 20))
    def pop(self, now: int) -> None:
        due = [key for key, (at, _) in self.expected.items() if at <= now]
        first = min(due, key=self.expected.__getitem__, default=None)
        assert self.deadlines.pop_due(now) == first
        if first is not None:
            del self.expected[first]

    @invariant()
    def the_earliest_is_next(self) -> None:
        earliest = min((at for at, _ in self.expected.values()), default=None)
        assert self.deadlines.next() == earliest


TestAgainstASortedList = AgainstASortedList.TestCase


# --- shared by many keys -------------------------------------------------------------------------


def test_keys_with_the_same_deadline_are_due_together_in_the_order_in_which_they_were_set() -> None:
    deadlines: SharedDeadlines[str] = SharedDeadlines()
    for key in ("lidar", "arm", "base"):
        deadlines.set(key, 10)
    deadlines.clear("arm")
    assert deadlines.pop_due(9) == ()
    assert deadlines.pop_due(10) == ("lidar", "base")
    assert deadlines.pop_due(10) == ()
    assert deadlines.next() is None


@given(
    st.lists(
        st.tuples(st.sampled_from("abcde"), st.one_of(st.none(), st.integers(0, 9))), max_size=40
    )
)
def test_shared_deadlines_agree_with_a_plain_table(steps: list[tuple[str, int | None]]) -> None:
    """A step sets or, with None, removes a deadline."""
    deadlines: SharedDeadlines[str] = SharedDeadlines()
    table: dict[str, int] = {}
    for key, at in steps:
        table.pop(key, None)
        if at is None:
            deadlines.clear(key)
        else:
            deadlines.set(key, at)
            table[key] = at
        assert deadlines.next() == min(table.values(), default=None)
        assert {key for key in "abcde" if key in deadlines} == table.keys()
    for now in range(10):
        due = deadlines.pop_due(now)
        assert due == tuple(key for key, at in table.items() if at == now)
        assert not deadlines.pop_due(now)


def test_the_earliest_is_told_by_name() -> None:
    deadlines = Deadlines[str]()
    assert deadlines.first() is None
    deadlines.set("late", 7)
    deadlines.set("early", 5)
    assert deadlines.first() == "early"
    deadlines.set("early", 9)
    assert deadlines.first() == "late"
