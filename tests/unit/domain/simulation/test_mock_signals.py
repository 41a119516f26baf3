import pytest

from domain.errors import UnknownSignalError
from domain.inputs import Reading, SignalValue
from domain.simulation.mock_signals import GOOD_VALUES, MockSignals
from domain.timebase import Instant, seconds, to_seconds

START = seconds(50.0)


def published(mock: MockSignals, until_s: float) -> list[tuple[float, dict[str, SignalValue]]]:
    """Return what is published until `until_s` after the start, with the time since then."""
    end = START + seconds(until_s)
    found = []
    while (at := mock.wake_at()) <= end:
        for message in mock.advance(at):
            values = {reading.signal: reading.value for reading in message.items}
            found.append((to_seconds(at - START), values))
    return found


def at(time_s: float) -> Instant:
    return START + seconds(time_s)


def test_the_first_readings_are_there_from_the_start_and_then_ten_a_second() -> None:
    mock = MockSignals(START)

    assert published(mock, 0.25) == [
        (0.0, GOOD_VALUES),
        (0.1, GOOD_VALUES),
        (0.2, GOOD_VALUES),
    ]
    assert len(published(mock, 10.0)) == 98


def test_readings_name_the_mock_as_their_source_and_bear_no_stamp() -> None:
    (message,) = MockSignals(START).advance(START)

    assert message.source == "mock"
    assert {reading.stamp for reading in message.items} == {None}


def test_a_held_value_is_published_at_once_alone_and_then_with_the_others() -> None:
    mock = MockSignals(START)
    published(mock, 0.12)
    mock.hold("battery_level", 0.42, at(0.12))

    assert published(mock, 0.2) == [
        (0.12, {"battery_level": 0.42}),
        (0.2, {**GOOD_VALUES, "battery_level": 0.42}),
    ]


def test_a_signal_that_is_not_published_is_left_out_and_the_others_go_on() -> None:
    mock = MockSignals(START)
    mock.set_publishing("temperature", False, START)
    published(mock, 0.0)

    ((_, values),) = published(mock, 0.1)

    assert values.keys() == GOOD_VALUES.keys() - {"temperature"}


def test_a_signal_that_is_taken_up_again_is_published_at_once() -> None:
    mock = MockSignals(START)
    published(mock, 0.0)
    mock.set_publishing("temperature", False, at(0.01))
    mock.set_publishing("temperature", True, at(0.05))

    assert published(mock, 0.05) == [(0.05, {"temperature": 30.0})]


def test_publishing_what_is_published_changes_nothing() -> None:
    mock = MockSignals(START)
    published(mock, 0.0)
    mock.set_publishing("temperature", True, at(0.05))

    assert published(mock, 0.09) == []


def test_a_value_held_while_the_signal_is_not_published_waits_until_it_is() -> None:
    mock = MockSignals(START)
    published(mock, 0.0)
    mock.set_publishing("estop", False, at(0.01))
    mock.hold("estop", True, at(0.02))

    assert published(mock, 0.09) == []

    mock.set_publishing("estop", True, at(0.09))
    assert published(mock, 0.09) == [(0.09, {"estop": True})]


def test_nothing_is_published_when_no_signal_is() -> None:
    mock = MockSignals(START)
    for signal in GOOD_VALUES:
        mock.set_publishing(signal, False, START)
    mock.advance(START)

    assert published(mock, 1.0) == []


def test_what_was_due_before_a_value_was_held_still_has_the_old_one() -> None:
    mock = MockSignals(START)
    mock.hold("battery_level", 0.42, at(0.05))

    first, second = mock.advance(at(0.05))

    assert first.items[0] == Reading("battery_level", 1.0)
    assert second.items == (Reading("battery_level", 0.42),)


def test_what_was_due_before_a_signal_was_stopped_still_has_it() -> None:
    mock = MockSignals(START)
    mock.set_publishing("battery_level", False, at(0.05))

    (message,) = mock.advance(at(0.05))

    assert len(message.items) == 5


def test_after_a_pause_it_publishes_once_and_keeps_to_its_grid() -> None:
    mock = MockSignals(START)
    published(mock, 0.0)

    assert len(mock.advance(at(7.23))) == 1
    assert mock.wake_at() == at(7.3)


def test_the_view_shows_what_is_held_and_whether_it_is_published() -> None:
    mock = MockSignals(START)
    mock.hold("estop", True, START)
    mock.set_publishing("gps_accuracy", False, START)

    assert {signal.signal: (signal.value, signal.publishing) for signal in mock.view()} == {
        "battery_level": (1.0, True),
        "estop": (True, True),
        "gps_accuracy": (100.0, False),
        "signal_strength": ("CONNECTED", True),
        "temperature": (30.0, True),
    }


def test_only_the_five_signals_are_mocked() -> None:
    mock = MockSignals(START)

    assert mock.holds("temperature")
    assert not mock.holds("wind_speed")
    with pytest.raises(UnknownSignalError, match="wind_speed"):
        mock.hold("wind_speed", 3.0, START)
    with pytest.raises(UnknownSignalError, match="wind_speed"):
        mock.set_publishing("wind_speed", False, START)


def test_a_signal_that_is_not_mocked_is_told_with_those_that_are() -> None:
    with pytest.raises(UnknownSignalError) as unknown:
        MockSignals(START).hold("wind_speed", 3.0, START)

    assert unknown.value.message == "there is no mock signal 'wind_speed'"
    assert unknown.value.hint == f"known: {', '.join(GOOD_VALUES)}"


def test_it_keeps_to_a_grid_that_begins_at_its_start() -> None:
    mock = MockSignals(seconds(0.03))
    mock.advance(seconds(0.03))
    assert mock.wake_at() == seconds(0.13)
    mock.advance(seconds(1.0))

    assert mock.wake_at() == seconds(1.03)


def test_a_signal_that_is_left_out_is_not_there_from_the_start_either() -> None:
    mock = MockSignals(START)
    mock.leave_out(["temperature", "motor_temperature"])

    ((_, values),) = published(mock, 0.0)

    assert values.keys() == GOOD_VALUES.keys() - {"temperature"}
    assert [each.signal for each in mock.view() if not each.publishing] == ["temperature"]
