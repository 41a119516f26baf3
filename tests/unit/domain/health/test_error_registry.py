"""Errors from any source: a door contact beside the signals."""

from collections.abc import Iterator, Mapping

import pytest

from domain.errors import InvalidValueError
from domain.findings import Blocker
from domain.health.error_registry import ErrorRegistry, ErrorSource
from domain.health.signal_monitor import SignalMonitor
from domain.health.signals import default_signals
from domain.inputs import Reading

DOOR = "DOOR_OPEN"


class Door:
    """A source that is no signal: open from one instant on, and closed by an acknowledgement."""

    bits: Mapping[str, int] = {DOOR: 128}

    def __init__(self, opens_at: int, error: str = DOOR) -> None:
        self.opens_at: int | None = opens_at
        self.error = error
        self.is_open = False

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


def test_an_error_may_come_from_a_source_that_is_no_signal() -> None:
    door = Door(opens_at=5)
    registry = ErrorRegistry([door])
    assert registry.next_wake() == 5

    registry.judge(5)

    assert registry.errors() == (DOOR,)
    assert [reason.message for reason in registry.reasons()] == ["the door is open"]
    assert registry.code(registry.errors()) == 128
    assert registry.next_wake() is None


def test_errors_of_all_sources_stand_in_the_order_of_their_bits() -> None:
    monitors, door = signals(), Door(opens_at=0)
    sources: list[ErrorSource] = [door, *monitors.values()]
    registry = ErrorRegistry(sources)
    monitors["estop"].receive(Reading("estop", True), "test", 0)
    registry.judge(0)

    assert registry.errors() == ("ESTOP", "STALE_DATA", DOOR)
    assert registry.reasons()[0].code == "ESTOP", "the stop first"
    assert registry.names[-1] == DOOR


def test_an_acknowledgement_reaches_the_source_of_the_error() -> None:
    door = Door(opens_at=0)
    registry = ErrorRegistry([door])
    registry.judge(0)

    registry.acknowledge("ESTOP", 1)
    assert registry.errors() == (DOOR,)
    registry.acknowledge(DOOR, 1)
    assert registry.errors() == ()


def test_an_error_that_two_sources_raise_is_on_until_both_are_done() -> None:
    front, back = Door(opens_at=0), Door(opens_at=0)
    registry = ErrorRegistry([front, back])
    registry.judge(0)

    front.is_open = False
    assert registry.errors() == (DOOR,)
    back.is_open = False
    assert registry.errors() == ()


def test_an_error_has_one_bit() -> None:
    class Hatch(Door):
        bits: Mapping[str, int] = {DOOR: 256}

    with pytest.raises(InvalidValueError, match="128 and 256"):
        ErrorRegistry([Door(0), Hatch(0)])
