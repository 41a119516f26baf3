"""Signals and the state of the robot as clients see them."""

import pytest

from api.http.schemas.health import (
    EmergencyStopJson,
    ReadingBody,
    SignalJson,
    StreamedSignalJson,
    SystemStateJson,
    read_stamp,
)
from domain.computers import ComputerName, StopId, StopView
from domain.errors import InvalidValueError
from domain.inputs import Reading
from domain.snapshot import EmergencyStopView
from domain.timebase import seconds
from tests.support.frames import IDLE, signal_view
from tests.support.manual_clock import ManualClock

CLOCK = ManualClock()
PENDING = signal_view("gps_accuracy", 250.0)._replace(
    pending_error="GPS_LOST",
    pending_since=seconds(1),
    pending_needs=seconds(15),
)


def test_a_frame_holds_no_age() -> None:
    shown = StreamedSignalJson.of(PENDING, CLOCK).model_dump()

    assert "age_s" not in shown
    assert shown["pending"] == {
        "error": "GPS_LOST",
        "since_at": "2026-01-01T00:00:01.000Z",
        "needs_s": 15.0,
    }


def test_a_question_is_answered_with_ages() -> None:
    shown = SignalJson.at(PENDING, CLOCK, seconds(7.5)).model_dump()

    assert shown["age_s"] == 6.5
    assert shown["pending"]["for_s"] == 6.5


def test_a_boolean_is_shown_as_one() -> None:
    view = signal_view("estop")._replace(value=True)

    assert '"value":true' in StreamedSignalJson.of(view, CLOCK).model_dump_json()


def test_the_system_state_is_of_one_moment() -> None:
    shown = SystemStateJson.of(IDLE, 12, seconds(3), ["nodes"], CLOCK)

    assert (shown.seq, shown.at, shown.simulated) == (12, "2026-01-01T00:00:03.000Z", ("nodes",))


def test_a_released_emergency_stop_has_nobody_who_pressed_it() -> None:
    shown = EmergencyStopJson.of(EmergencyStopView(False, None, None, None, None), CLOCK)

    assert shown.model_dump() == {
        "engaged": False,
        "by": None,
        "reason": None,
        "since_at": None,
        "standstill_at": None,
        "stops": [],
        "waits_for": (),
        "not_heard": (),
    }


def test_an_engaged_emergency_stop_says_on_which_computers_it_is() -> None:
    arm, base = ComputerName("arm"), ComputerName("base")
    stops = (
        StopView(StopId("arm-1"), arm, "ada", "a child", seconds(1)),
        StopView(StopId("stop-7"), None, "bert", "me too", seconds(2)),
    )
    view = EmergencyStopView(True, "ada", "a child", seconds(1), None, stops, (arm,), (base,))

    shown = EmergencyStopJson.of(view, CLOCK).model_dump()

    assert shown["stops"][0] == {
        "id": "arm-1",
        "device": "arm",
        "by": "ada",
        "reason": "a child",
        "since_at": "2026-01-01T00:00:01.000Z",
    }
    assert shown["stops"][1]["device"] is None
    assert (shown["waits_for"], shown["not_heard"]) == (("arm",), ("base",))


@pytest.mark.parametrize(
    "stamp", ["2026-01-01T00:00:02Z", "2026-01-01T01:00:02+01:00", "2026-01-01T00:00:02.000Z"]
)
def test_a_stamp_is_moved_to_our_clock(stamp: str) -> None:
    body = ReadingBody(value=1.0, stamp=stamp)

    assert body.reading("temperature", CLOCK) == Reading("temperature", 1.0, seconds(2))


@pytest.mark.parametrize("stamp", ["", "now", "2026-01-01T00:00:02", "2026-02-30T00:00:00Z"])
def test_a_stamp_that_is_no_moment_is_told_with_its_place(stamp: str) -> None:
    with pytest.raises(InvalidValueError) as raised:
        read_stamp(stamp, CLOCK)

    assert raised.value.pointer == "/stamp"
