"""What is told of signals, errors, the emergency stop and the state of the robot."""

from dataclasses import replace

import pytest

from domain.computers import SUPERVISOR, ComputerName, StopId
from domain.events.event import Event
from domain.events.health import (
    EmergencyStopEngaged,
    EmergencyStopReleased,
    EmergencyStopStandstill,
    ErrorAcknowledged,
    ErrorCleared,
    ErrorRaised,
    ErrorReported,
    PeerStopEngaged,
    PeerStopReleased,
    PropagationNotSeen,
    SignalLimitsChanged,
    SignalNotRead,
    SignalPending,
    SignalRead,
    SignalSettled,
    StopReleaseAsked,
    SystemStateChanged,
)
from domain.snapshot import SystemState
from domain.state_and_mode import PartName

ARM = PartName("arm")
DEVICE, STOP = ComputerName("arm"), StopId("0f0f-3")
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
            SignalLimitsChanged("load", "drive_base.FAST", above=60.0),
            "load is bad above 60: drive_base.FAST",
        ),
        (SignalLimitsChanged("load", "default", below=2.5), "load is bad below 2.5: default"),
        (
            SignalLimitsChanged("load", None),
            "no value of load is bad: none of its limits applies",
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
        (ErrorReported(ARM, "JAMMED", True, "it is stuck", 3), "arm.JAMMED reported: it is stuck"),
        (ErrorReported(ARM, "JAMMED", False, "", None), "arm.JAMMED reported over"),
        (
            PropagationNotSeen("LATE", ARM, "GPS_LOST", None, 2.0),
            "GPS_LOST has been on for 2 s without arm.LATE",
        ),
        (ErrorAcknowledged("ESTOP"), "ESTOP acknowledged"),
        (EmergencyStopEngaged("a child"), "emergency stop engaged: a child"),
        (EmergencyStopReleased("track clear"), "emergency stop released"),
        (
            EmergencyStopReleased("track clear", (DEVICE, SUPERVISOR)),
            "emergency stop released here; one is still engaged at device arm, the supervisor",
        ),
        (
            PeerStopEngaged(DEVICE, STOP, "ada", "a child"),
            "emergency stop engaged at device arm by ada: a child",
        ),
        (PeerStopEngaged(SUPERVISOR, STOP, "", ""), "emergency stop engaged at the supervisor"),
        (PeerStopReleased(DEVICE, STOP), "emergency stop at device arm released"),
        (StopReleaseAsked(DEVICE, (STOP,)), "device arm asked to release its emergency stop"),
        (EmergencyStopStandstill(), "the vehicle is at standstill after the emergency stop"),
    ],
    ids=lambda value: value.kind if isinstance(value, Event) else "",
)
def test_an_event_says_in_words_what_happened(event: Event, words: str) -> None:
    assert event.words == words


def test_an_error_that_may_still_not_come_is_detail() -> None:
    assert not SignalPending("gps_accuracy", "GPS_LOST").notable
    assert ErrorRaised("ESTOP", "it is pressed", True, None).notable


def test_what_another_error_explains_is_detail() -> None:
    late = ErrorRaised("LATE", "the map is old", 2.0, 1.0, ARM)
    assert late.notable
    assert not replace(late, root_cause=False).notable
    assert not ErrorCleared("LATE", ARM, root_cause=False).notable


def test_an_error_that_is_silenced_is_detail() -> None:
    assert not ErrorRaised("ESTOP", "it is pressed", True, None, silenced=True).notable
    assert not ErrorCleared("ESTOP", silenced=True).notable
    assert ErrorCleared("ESTOP").notable
