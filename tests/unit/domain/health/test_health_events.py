"""What is told of the robot's health, and what led to it."""

import pytest

from domain.events import Event
from domain.health.health_events import HealthEvents
from domain.health.signals import default_signals
from domain.health.state_manager import HealthChanges, StateManager
from domain.inputs import Reading, Readings, SignalValue
from domain.outbox import Outbox, Outputs
from domain.snapshot import TaskStatus
from domain.timebase import seconds
from tests.support.good import GOOD


class Health:
    """A state manager with what is told of it."""

    def __init__(self) -> None:
        self.manager = StateManager(default_signals(), 0)
        self.outbox = Outbox()
        self.told = HealthEvents(self.manager, self.outbox)
        self.events: dict[int, Event] = {}
        self.now = 0
        self.task_status = TaskStatus.NO_TASK
        self.last = Outputs()

    def read(self, stamp: int | None = None, /, **values: SignalValue) -> list[Event]:
        self.outbox.begin(self.now, "signal.read")
        items = tuple(Reading(name, value, stamp) for name, value in values.items())
        changes = self.manager.receive(Readings(items, "test"), self.now)
        self._tell(changes)
        return self._taken()

    def keep_reading(self, duration_s: float, **values: SignalValue) -> list[Event]:
        """Read every 500 ms, so that nothing is stale."""
        events = []
        for _ in range(round(duration_s / 0.5)):
            events += self.pass_time(0.5)
            events += self.read(**{**GOOD, **values})
        return events

    def pass_time(self, duration_s: float) -> list[Event]:
        end = self.now + seconds(duration_s)
        events = []
        while (due := self.manager.wake_at()) is not None and due <= end:
            self.now = due
            self.outbox.begin(due, "time.passed")
            self._tell(self.manager.pass_time(due))
            events += self._taken()
        self.now = end
        return events

    def root(self, event: Event) -> str:
        while event.cause is not None:
            event = self.events[event.cause]
        return event.kind

    def _tell(self, changes: HealthChanges) -> None:
        cause = self.told.publish(changes)
        self.told.tell_state(self.task_status, cause)

    def _taken(self) -> list[Event]:
        self.last = self.outbox.take()
        events = list(self.last.events)
        self.events |= {event.id: event for event in events}
        return events


@pytest.fixture
def health() -> Health:
    health = Health()
    health.read(**GOOD)
    return health


def _kinds(events: list[Event]) -> list[str]:
    return [event.kind for event in events]


def _only(events: list[Event], kind: str) -> Event:
    (event,) = [event for event in events if event.kind == kind]
    return event


def test_a_reading_that_changes_nothing_leaves_no_trace(health: Health) -> None:
    assert health.read(**GOOD) == []
    assert not health.last.system_state


def test_an_error_is_told_with_its_value_its_limit_and_the_reading_that_caused_it(
    health: Health,
) -> None:
    events = health.read(battery_level=0.42)
    assert _kinds(events) == ["signal.read", "error.raised", "system_state.changed"]
    raised = _only(events, "error.raised")
    assert raised.cause == events[0].id
    assert raised.data == {
        "error": "BATTERY_LOW",
        "message": "battery 42 % is below 50 %",
        "value": 0.42,
        "threshold": 0.5,
    }


def test_the_state_is_told_with_all_errors_and_their_code(health: Health) -> None:
    health.read(battery_level=0.42)
    changed = _only(health.read(temperature=60.0), "system_state.changed")
    assert changed.data == {
        "state": "ERROR",
        "was": "ERROR",
        "errors": ["BATTERY_LOW", "TEMPERATURE_HIGH"],
        "error_code": 33,
    }


def test_another_reason_for_the_same_errors_is_no_news_of_the_state(health: Health) -> None:
    health.read(battery_level=0.42)
    assert health.read(battery_level=0.41) == []
    assert not health.last.system_state, "the next tick shows it"


def test_the_end_of_an_error_is_told(health: Health) -> None:
    health.read(battery_level=0.42)
    health.pass_time(0.5)
    events = health.read(**GOOD)
    assert _only(events, "error.cleared").data == {"error": "BATTERY_LOW"}
    assert _only(events, "system_state.changed").data["state"] == "IDLE"


def test_an_error_that_needs_time_is_told_when_it_begins_to_count(health: Health) -> None:
    events = health.read(gps_accuracy=300.0)
    assert _kinds(events) == ["signal.read", "signal.pending"]
    assert events[1].data == {"signal": "gps_accuracy", "error": "GPS_LOST"}


def test_what_stopped_counting_is_told(health: Health) -> None:
    health.read(gps_accuracy=300.0)
    events = health.read(gps_accuracy=100.0)
    assert _only(events, "signal.settled").data == {"signal": "gps_accuracy", "error": "GPS_LOST"}


def test_an_error_that_time_raised_is_caused_by_the_reading_that_first_was_bad(
    health: Health,
) -> None:
    first = health.read(gps_accuracy=300.0)
    raised = _only(health.keep_reading(15, gps_accuracy=300.0), "error.raised")
    assert raised.cause == first[1].id
    assert health.root(raised) == "signal.read"


def test_a_state_that_time_changed_is_caused_by_the_reading_that_first_was_bad(
    health: Health,
) -> None:
    health.read(gps_accuracy=300.0)
    changed = _only(health.keep_reading(15, gps_accuracy=300.0), "system_state.changed")
    assert health.root(changed) == "signal.read"


def test_what_settled_does_not_cause_the_next_error(health: Health) -> None:
    health.read(gps_accuracy=300.0)
    health.keep_reading(1)
    second = health.read(gps_accuracy=300.0)
    raised = _only(health.keep_reading(15, gps_accuracy=300.0), "error.raised")
    assert raised.cause == second[1].id


def test_an_error_that_comes_at_once_is_not_laid_to_what_settled_before(health: Health) -> None:
    """From NOT_CONNECTED to LOW_SIGNAL there is no gap, and so nothing that began to count."""
    health.read(signal_strength="LOW_SIGNAL")
    health.keep_reading(1)
    health.read(signal_strength="NOT_CONNECTED")
    health.keep_reading(10, signal_strength="NOT_CONNECTED")
    low = health.read(signal_strength="LOW_SIGNAL")
    raised = _only(low, "error.raised")
    assert raised.data["error"] == "SIGNAL_LOW"
    assert raised.cause == low[0].id


def test_what_led_to_an_error_once_does_not_cause_it_again(health: Health) -> None:
    health.read(gps_accuracy=300.0)
    health.keep_reading(15, gps_accuracy=300.0)
    health.keep_reading(1)
    again = health.read(gps_accuracy=300.0)
    raised = _only(health.keep_reading(15, gps_accuracy=300.0), "error.raised")
    assert raised.cause == again[1].id


def test_silence_has_no_cause_but_time(health: Health) -> None:
    raised = _only(health.pass_time(3), "error.raised")
    assert raised.data["error"] == "STALE_DATA"
    assert health.root(raised) == "time.passed"


def test_a_sender_whose_clock_is_off_is_told_once(health: Health) -> None:
    events = health.read(seconds(100), temperature=20.0)
    assert _only(events, "signal.skewed").data == {"signal": "temperature"}
    assert health.read(seconds(101), temperature=20.0) == []


def test_a_robot_that_is_good_for_the_first_time_is_no_longer_in_error() -> None:
    """It began in ERROR: nothing was read yet."""
    changed = _only(Health().read(**GOOD), "system_state.changed")
    assert (changed.data["was"], changed.data["state"]) == ("ERROR", "IDLE")


def test_signals_whose_view_changed_are_named() -> None:
    health = Health()
    changes = health.manager.receive(Readings((Reading("estop", False),), "test"), 0)
    health.outbox.begin(0, "signal.read")
    health.told.publish(changes)
    outputs = health.outbox.take()
    assert outputs.signals == {"estop"}
    assert not outputs.system_state, "one reason less, and the same errors"


def test_a_task_makes_an_idle_robot_a_running_one(health: Health) -> None:
    health.task_status = TaskStatus.RUNNING_TASK
    changed = _only(health.read(**GOOD), "system_state.changed")

    assert (changed.data["was"], changed.data["state"]) == ("IDLE", "RUNNING")


def test_a_task_that_pauses_is_told_though_the_robot_goes_on_running(health: Health) -> None:
    health.task_status = TaskStatus.RUNNING_TASK
    health.read(**GOOD)
    health.task_status = TaskStatus.PAUSED_TASK

    assert health.read(**GOOD) == []
    assert health.last.system_state
