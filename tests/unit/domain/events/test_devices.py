"""What is told of devices."""

import pytest

from domain.computers import ComputerName, DeviceState
from domain.events.devices import (
    DeviceConflict,
    DeviceConnected,
    DeviceLate,
    DeviceLost,
    DeviceReported,
)
from domain.events.event import Event

ARM = ComputerName("arm")
LATE, LOST, NEVER_SEEN = DeviceState.LATE, DeviceState.LOST, DeviceState.NEVER_SEEN
SILENT = "device arm has not been heard for 1.5 s"


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (DeviceConnected(ARM, NEVER_SEEN, restarted=False), "device arm is connected"),
        (DeviceConnected(ARM, LOST, restarted=True), "device arm is connected after a restart"),
        (DeviceLate(ARM, SILENT), SILENT),
        (DeviceLate(ARM, ""), "device arm is late"),
        (DeviceLost(ARM, SILENT), SILENT),
        (DeviceLost(ARM, ""), "device arm is not connected"),
        (
            DeviceConflict(ARM, "another process is device arm"),
            "conflict about device arm: another process is device arm",
        ),
        (DeviceReported(ARM, "0.9.1", autonomous=False), "device arm runs version 0.9.1"),
        (DeviceReported(ARM, None, autonomous=False), "device arm runs version unknown"),
        (DeviceReported(ARM, "0.9.1", autonomous=True), "device arm acts on its own"),
    ],
    ids=lambda value: value.kind if isinstance(value, Event) else "",
)
def test_an_event_says_in_words_what_happened(event: Event, words: str) -> None:
    assert event.words == words


def test_a_short_list_leaves_out_that_a_device_was_late_for_a_moment() -> None:
    assert not DeviceLate(ARM, "").notable
    assert not DeviceConnected(ARM, LATE, restarted=False).notable
    assert DeviceConnected(ARM, LATE, restarted=True).notable
    assert DeviceConnected(ARM, LOST, restarted=False).notable
    assert DeviceLost(ARM, SILENT).notable


def test_a_short_list_shows_that_a_device_acts_on_its_own() -> None:
    assert DeviceReported(ARM, None, autonomous=True).notable
    assert not DeviceReported(ARM, None, autonomous=False).notable
