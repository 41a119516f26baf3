"""What is told of signals, errors, the emergency stop and the state of the robot."""

import pytest

from domain.events.event import Event
from domain.events.health import (
    EmergencyStopEngaged,
    EmergencyStopReleased,
    EmergencyStopStandstill,
    ErrorAcknowledged,
    ErrorCleared,
    ErrorRaised,
    SignalNotRead,
    SignalPending,
    SignalRead,
    SignalSettled,
    SystemStateChanged,
)
from domain.snapshot import SystemState

IDLE, ERROR = SystemState.IDLE, SystemState.ERROR


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (
            SystemStateChanged(ERROR, IDLE, ("ESTOP", "GPS_LOST"), 6),
            "IDLE -> ERROR: ESTOP, GPS_LOST",
        ),
        (SystemStateChanged(IDLE, ERROR, (), 0), "ERROR -> IDLE"),
        (SystemStateChanged(ERROR, ERROR, ("ESTOP",), 2), "ERROR: ESTOP"),
        (SignalRead("gps", {"gps_accuracy": 20.0}), "gps_accuracy 20.0 (source gps)"),
        (
            SignalNotRead("disk", "os disk /", "no answer within 1 s"),
            "no reading of disk from os disk /: no answer within 1 s",
        ),
        (
            SignalPending("gps_accuracy", "GPS_LOST"),
            "gps_accuracy is bad; GPS_LOST follows if it lasts",
        ),
        (SignalSettled("gps_accuracy", "GPS_LOST", False), "gps_accuracy recovered; no GPS_LOST"),
        (
            SignalSettled("load", "OVERLOAD", True),
            "load is stale; the time of OVERLOAD begins anew",
        ),
        (ErrorRaised("ESTOP", "it is pressed", True, None), "ESTOP: it is pressed"),
        (ErrorCleared("ESTOP"), "ESTOP cleared"),
        (ErrorAcknowledged("ESTOP"), "ESTOP acknowledged"),
        (EmergencyStopEngaged("a child"), "emergency stop engaged: a child"),
        (EmergencyStopReleased("track clear"), "emergency stop released"),
        (EmergencyStopStandstill(), "the vehicle is at standstill after the emergency stop"),
    ],
    ids=lambda value: value.kind if isinstance(value, Event) else "",
)
def test_an_event_says_in_words_what_happened(event: Event, words: str) -> None:
    assert event.words == words


def test_an_error_that_may_still_not_come_is_detail() -> None:
    assert not SignalPending("gps_accuracy", "GPS_LOST").notable
    assert ErrorRaised("ESTOP", "it is pressed", True, None).notable
