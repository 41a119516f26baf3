"""Errors from any source: a door contact beside the signals."""

from collections.abc import Iterator, Mapping

import pytest

from domain.errors import InvalidValueError
from domain.findings import Blocker
from domain.health.error_registry import ErrorChanges, ErrorRegistry, ErrorSource
from domain.health.signal_monitor import SignalMonitor
from domain.health.signals import Raisable, default_signals
from domain.inputs import Reading
from domain.snapshot import ErrorKey
from domain.state_and_mode import PartName

DOOR = "DOOR_OPEN"
KEY = ErrorKey(None, DOOR)


class Door:
    """A source that is no signal: open from one instant on, and closed by an acknowledgement."""

    can_raise: Mapping[str, Raisable] = {DOOR: Raisable(KEY, 128)}

    def __init__(self, opens_at: int, error: str = DOOR) -> None:
        self.opens_at: int | None = opens_at
        self.error = error
        self.is_open = False

    @property
    def is_on(self) -> bool:
        return self.is_open

    @property
    def errors(self) -> frozenset[str]:
        return frozenset({self.error}) if self.is_open else frozenset()

    @property
    def present(self) -> frozenset[str]:
        return self.errors

    def reasons(self) -> Iterator[Blocker]:
        if self.is_open:
            yield Blocker(self.error, "the door is open", ("door",))

    def acknowledge(self, error: str, now: int) -> None:
        self.is_open = self.is_open and error != self.error

    def judge(self, now: int) -> None:
        if self.opens_at is not None and now >= self.opens_at:
            self.opens_at, self.is_open = None, True

    def wake_at(self) -> int | None:
        return self.opens_at


def signals() -> dict[str, SignalMonitor]:
    return {item.spec.name: SignalMonitor(item, 0) for item in default_signals()}


def joined(*sources: ErrorSource, at: int = 0) -> ErrorRegistry:
    registry = ErrorRegistry(sources)
    registry.judge(at)
    registry.renew()
    return registry


def test_an_error_may_come_from_a_source_that_is_no_signal() -> None:
    registry = ErrorRegistry([Door(opens_at=5)])
    assert registry.next_wake() == 5

    registry.judge(5)
    changes = registry.renew()

    assert (changes.raised, changes.cleared, changes.explained) == ((KEY,), (), (KEY,))
    assert registry.errors == (DOOR,)
    assert [reason.message for reason in registry.reasons] == ["the door is open"]
    assert registry.code == 128
    assert registry.next_wake() is None


def test_errors_of_all_sources_stand_in_the_order_of_their_bits() -> None:
    monitors, door = signals(), Door(opens_at=0)
    monitors["estop"].receive(Reading("estop", True), "test", 0)
    registry = joined(door, *monitors.values())

    assert registry.errors == ("ESTOP", "STALE_DATA", DOOR)
    assert registry.reasons[0].code == "ESTOP", "the stop first"
    assert [key.error for key in registry.order][-1] == DOOR


def test_an_acknowledgement_reaches_the_source_of_the_error() -> None:
    registry = joined(Door(opens_at=0))

    registry.acknowledge(ErrorKey(None, "ESTOP"), 1)
    registry.renew()
    assert registry.errors == (DOOR,)
    registry.acknowledge(KEY, 1)
    assert registry.renew().cleared == (KEY,)
    assert not registry.errors


def test_an_error_that_two_sources_raise_is_on_until_both_are_done() -> None:
    front, back = Door(opens_at=0), Door(opens_at=0)
    registry = joined(front, back)

    front.is_open = False
    registry.touch(0)
    assert registry.renew() == ErrorChanges(explained=(KEY,))
    assert registry.errors == (DOOR,)
    back.is_open = False
    registry.touch(1)
    registry.renew()
    assert not registry.errors


def test_only_sources_that_were_touched_or_are_due_are_looked_at() -> None:
    class CountingDoor(Door):
        looks = 0

        @property
        def errors(self) -> frozenset[str]:
            CountingDoor.looks += 1
            return super().errors

    registry = joined(*(CountingDoor(opens_at=number) for number in range(1_000)))
    CountingDoor.looks = 0

    registry.touch(7)
    registry.renew()
    registry.judge(1)
    registry.renew()

    assert 0 < CountingDoor.looks <= 6, "doors 7 and 1, however many there are"


def test_an_error_without_a_bit_is_on_and_the_robot_is_well() -> None:
    class Hatch(Door):
        can_raise: Mapping[str, Raisable] = {
            "OPEN": Raisable(ErrorKey(PartName("hatch"), "OPEN"), 0)
        }

    registry = joined(Door(opens_at=9), Hatch(opens_at=0, error="OPEN"))

    hatch = ErrorKey(PartName("hatch"), "OPEN")
    assert registry.is_on(hatch)
    assert registry.reason(hatch).message == "the door is open"
    assert (registry.errors, registry.code, registry.reasons) == ((), 0, ())
    assert list(registry.order) == [KEY, hatch], "errors without a bit come last"


def test_an_error_has_one_bit() -> None:
    class Hatch(Door):
        can_raise: Mapping[str, Raisable] = {DOOR: Raisable(KEY, 256)}

    with pytest.raises(InvalidValueError, match="128 and 256"):
        ErrorRegistry([Door(0), Hatch(0)])


def test_a_deadline_that_is_put_off_is_looked_up_when_it_comes_up() -> None:
    doors = Door(opens_at=5), Door(opens_at=7)
    registry = ErrorRegistry(doors)
    doors[0].opens_at = 9
    registry.postpone(0)
    assert registry.next_wake() == 7
    doors[1].opens_at = None
    registry.replan(1, None)
    assert registry.next_wake() == 9
    registry.judge(8)
    assert not doors[0].is_open
    registry.judge(9)
    assert doors[0].is_open


def test_a_deadline_that_comes_earlier_is_not_put_off() -> None:
    door = Door(opens_at=5)
    registry = ErrorRegistry([door, Door(opens_at=4)])
    registry.replan(0, None)
    door.opens_at = 3
    registry.replan(0, 3)
    assert registry.next_wake() == 3


def test_a_source_is_touched_until_that_is_taken_over() -> None:
    registry = joined(Door(opens_at=5), Door(opens_at=7))
    registry.touch(1)
    assert (registry.is_touched(0), registry.is_touched(1)) == (False, True)
    registry.renew()
    assert not registry.is_touched(1)


def test_a_source_that_is_taken_out_is_not_due() -> None:
    door = Door(opens_at=5)
    registry = ErrorRegistry([door, Door(opens_at=7)])
    registry.take_out(0)
    assert registry.next_wake() == 7
    assert registry.touched() == [0]
    registry.renew()
    assert registry.next_wake() == 5, "it was not judged"
