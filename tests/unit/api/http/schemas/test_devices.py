"""The computers of a robot as clients see them: what may be left out, and what is null."""

from dataclasses import replace

from api.http.schemas.devices import DeviceJson, DevicesJson, ListedDeviceJson, OfflineJson
from domain.computers import Connection, DeviceState
from domain.devices.settings import OfflineSettings
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import seconds
from tests.support.frames import device_view
from tests.support.manual_clock import ManualClock

CLOCK = ManualClock()
ARM = device_view("arm")


def test_what_a_device_does_when_it_is_cut_off_is_told_by_labels() -> None:
    targets = {PartName("arm"): StateAndMode.parse("active.SLOW")}
    shown = OfflineJson.of(OfflineSettings(seconds(2.5), targets, reactions=True))

    assert shown.model_dump() == {
        "after_s": 2.5,
        "target": {"arm": "active.SLOW"},
        "reactions": True,
    }


def test_a_device_that_was_never_heard_has_no_time_and_no_age() -> None:
    shown = ListedDeviceJson.at(ARM, Connection(), CLOCK, seconds(3))

    assert (shown.heard_at, shown.heard_age_s) == (None, None)


def test_the_age_is_that_of_the_last_sign_of_life() -> None:
    lost = replace(ARM, state=DeviceState.LOST, since=seconds(2.5))
    shown = ListedDeviceJson.at(lost, Connection(heard_at=seconds(1)), CLOCK, seconds(3))

    assert (shown.heard_at, shown.since_at) == (
        "2026-01-01T00:00:01.000Z",
        "2026-01-01T00:00:02.500Z",
    )
    assert shown.heard_age_s == 2.0


def test_frames_have_no_ages() -> None:
    assert "heard_age_s" not in DeviceJson.model_fields


def test_only_a_device_says_which_it_is() -> None:
    schema = DevicesJson.model_json_schema(mode="serialization")

    assert schema["required"] == ["items"]
