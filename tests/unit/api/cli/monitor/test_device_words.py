import pytest

from api.cli.monitor.device_words import (
    amiss,
    device_problems,
    heard_last,
    is_away,
    not_stopped_words,
    own_words,
    state_words,
    stop_places,
)
from api.cli.monitor.store import Json
from tests.support.device_cases import CASES, PLACES, DeviceCase
from tests.support.monitor import AT, device, this_device


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_what_is_said_of_devices(case: DeviceCase) -> None:
    found = amiss(case.devices)

    assert tuple(f"{each['device']} {state_words(each)}" for each in found) == case.amiss
    assert tuple(device_problems(case.devices)) == case.problems
    assert not_stopped_words(case.devices) == case.not_stopped


@pytest.mark.parametrize(("stop", "words"), PLACES)
def test_it_is_said_where_a_stop_is_engaged(stop: Json, words: str) -> None:
    assert stop_places(stop) == words


def test_a_device_that_is_late_still_counts_as_heard() -> None:
    assert not is_away(device("arm", "late"))
    assert not is_away(None)
    assert is_away(device("arm", "never_seen"))


def test_values_of_a_device_that_is_away_are_as_old_as_its_last_sign_of_life() -> None:
    assert heard_last(device("arm", "lost")) == AT
    assert heard_last(device("arm", "lost", heard_at=None, since_at="then")) == "then"
    assert heard_last(device("arm", "late")) is None
    assert heard_last(device("arm", "never_seen")) is None


def test_a_device_says_whose_word_counts() -> None:
    assert own_words(this_device("arm", "cut_off")) == "device arm: cut off"
