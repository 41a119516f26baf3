"""What is told of the robot's health, and what led to it."""

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import pytest

from domain.events.event import RecordedEvent
from domain.events.health import ErrorAcknowledged
from domain.events.service import TimeWasDue
from domain.health.health import Health
from domain.health.signals import (
    Bound,
    Comparison,
    Recovery,
    SignalKind,
    SignalSettings,
    SignalSpec,
    default_signals,
)
from domain.inputs import (
    Reading,
    Readings,
    Restored,
    SignalValue,
    SourceFault,
)
from domain.kept import KeptError
from domain.outbox import Outbox, Outputs
from domain.restart import Restart
from domain.robot_state import RobotState
from domain.snapshot import ErrorKey, TaskStatus
from domain.storage import Storage
from domain.tasks.driving import Driving
from domain.timebase import Instant, seconds
from tests.support.good import GOOD


class Robot:
    """The health of a robot, and its state, with what is told of both."""

    def __init__(
        self, signals: tuple[SignalSettings, ...] = default_signals(), now: Instant = 0
    ) -> None:
        self.outbox = Outbox()
        self.health = Health(signals, self.outbox, now)
        self.driving = SimpleNamespace(status=TaskStatus.NO_TASK, still_moving=None)
        self.state = RobotState(
            self.health, cast("Driving", self.driving), Storage(self.outbox), self.outbox
        )
        self.events: dict[int, RecordedEvent] = {}
        self.now = now
        self.last = Outputs()

    def read(self, stamp: int | None = None, /, **values: SignalValue) -> list[RecordedEvent]:
        items = tuple(Reading(name, value, stamp) for name, value in values.items())
        self.health.take_readings(Readings(items, "test"), self.now)
        return self._taken()

    def fail(self, reason: str) -> list[RecordedEvent]:
        self.health.take_fault(SourceFault("temperature", "file", reason), self.now)
        return self._taken()

    def acknowledge(self, error: str) -> list[RecordedEvent]:
        self.outbox.begin(self.now, ErrorAcknowledged(error))
        self.health.acknowledge(ErrorKey(None, error), self.now)
        return self._taken()

    def restore(self, *kept: KeptError) -> list[RecordedEvent]:
        restored = Restored(kept)
        Restart(self.outbox).take_restored(restored, self.now)
        self.health.restore(restored, self.now)
        return self._taken()

    def keep_reading(self, duration_s: float, **values: SignalValue) -> list[RecordedEvent]:
        """Read every 500 ms, so that nothing is stale."""
        events = []
        for _ in range(round(duration_s / 0.5)):
            events += self.pass_time(0.5)
            events += self.read(**{**GOOD, **values})
        return events

    def pass_time(self, duration_s: float) -> list[RecordedEvent]:
        end = self.now + seconds(duration_s)
        events = []
        while (due := self.health.wake_at()) is not None and due <= end:
            self.now = due
            self.outbox.begin(due, TimeWasDue())
            self.health.pass_time(due)
            events += self._taken()
        self.now = end
        return events

    def root(self, event: RecordedEvent) -> str:
        while event.cause is not None:
            event = self.events[event.cause]
        return event.kind

    def _taken(self) -> list[RecordedEvent]:
        self.state.settle(self.now)
        self.last = self.outbox.take()
        events = list(self.last.events)
        self.events |= {event.id: event for event in events}
        return events


@pytest.fixture
def health() -> Robot:
    health = Robot()
    health.read(**GOOD)
    return health


def _kinds(events: list[RecordedEvent]) -> list[str]:
    return [event.kind for event in events]


def _only(events: list[RecordedEvent], kind: str) -> RecordedEvent:
    (event,) = [event for event in events if event.kind == kind]
    return event


def test_a_reading_that_changes_nothing_leaves_no_trace(health: Robot) -> None:
    assert health.read(**GOOD) == []
    assert not health.last.system_state


def test_an_error_is_told_with_its_value_its_limit_and_the_reading_that_caused_it(
    health: Robot,
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
        "part": None,
        "root_cause": True,
        "silenced": False,
    }


def test_the_state_is_told_with_all_errors_and_their_code(health: Robot) -> None:
    health.read(battery_level=0.42)
    changed = _only(health.read(temperature=60.0), "system_state.changed")
    assert changed.data == {
        "state": "ERROR",
        "was": "ERROR",
        "errors": ["BATTERY_LOW", "TEMPERATURE_HIGH"],
        "error_code": 33,
    }


def test_another_reason_for_the_same_errors_is_no_news_of_the_state(health: Robot) -> None:
    health.read(battery_level=0.42)
    assert health.read(battery_level=0.41) == []
    assert not health.last.system_state, "the next tick shows it"


def test_the_end_of_an_error_is_told(health: Robot) -> None:
    health.read(battery_level=0.42)
    health.pass_time(0.5)
    events = health.read(**GOOD)
    assert _only(events, "error.cleared").data == {
        "error": "BATTERY_LOW",
        "part": None,
        "root_cause": True,
        "silenced": False,
    }
    assert _only(events, "system_state.changed").data["state"] == "IDLE"


def test_an_error_that_needs_time_is_told_when_it_begins_to_count(health: Robot) -> None:
    events = health.read(gps_accuracy=300.0)
    assert _kinds(events) == ["signal.read", "signal.pending"]
    assert events[1].data == {"signal": "gps_accuracy", "error": "GPS_LOST"}


def test_what_stopped_counting_is_told(health: Robot) -> None:
    health.read(gps_accuracy=300.0)
    events = health.read(gps_accuracy=100.0)
    assert _only(events, "signal.settled").data == {
        "signal": "gps_accuracy",
        "error": "GPS_LOST",
        "stale": False,
    }


def test_an_error_that_time_raised_is_caused_by_the_reading_that_first_was_bad(
    health: Robot,
) -> None:
    first = health.read(gps_accuracy=300.0)
    raised = _only(health.keep_reading(15, gps_accuracy=300.0), "error.raised")
    assert raised.cause == first[1].id
    assert health.root(raised) == "signal.read"


def test_a_state_that_time_changed_is_caused_by_the_reading_that_first_was_bad(
    health: Robot,
) -> None:
    health.read(gps_accuracy=300.0)
    changed = _only(health.keep_reading(15, gps_accuracy=300.0), "system_state.changed")
    assert health.root(changed) == "signal.read"


def test_what_settled_does_not_cause_the_next_error(health: Robot) -> None:
    health.read(gps_accuracy=300.0)
    health.keep_reading(1)
    second = health.read(gps_accuracy=300.0)
    raised = _only(health.keep_reading(15, gps_accuracy=300.0), "error.raised")
    assert raised.cause == second[1].id


def test_an_error_that_comes_at_once_is_not_laid_to_what_settled_before(health: Robot) -> None:
    """From NOT_CONNECTED to LOW_SIGNAL there is no gap, and so nothing that began to count."""
    health.read(signal_strength="LOW_SIGNAL")
    health.keep_reading(1)
    health.read(signal_strength="NOT_CONNECTED")
    health.keep_reading(10, signal_strength="NOT_CONNECTED")
    low = health.read(signal_strength="LOW_SIGNAL")
    raised = _only(low, "error.raised")
    assert raised.data["error"] == "SIGNAL_LOW"
    assert raised.cause == low[0].id


def test_what_led_to_an_error_once_does_not_cause_it_again(health: Robot) -> None:
    health.read(gps_accuracy=300.0)
    health.keep_reading(15, gps_accuracy=300.0)
    health.keep_reading(1)
    again = health.read(gps_accuracy=300.0)
    raised = _only(health.keep_reading(15, gps_accuracy=300.0), "error.raised")
    assert raised.cause == again[1].id


def test_silence_has_no_cause_but_time(health: Robot) -> None:
    raised = _only(health.pass_time(3), "error.raised")
    assert raised.data["error"] == "STALE_DATA"
    assert health.root(raised) == "time.passed"


def test_why_a_source_gives_no_reading_is_told_once_until_it_changes(health: Robot) -> None:
    told = _only(health.fail("no such file"), "signal.not_read")
    assert told.data == {"signal": "temperature", "source": "file", "reason": "no such file"}
    assert health.last.signals == {"temperature"}

    assert health.fail("no such file") == []
    _only(health.fail("permission denied"), "signal.not_read")


def test_a_sender_whose_clock_is_off_is_told_once(health: Robot) -> None:
    events = health.read(seconds(100), temperature=20.0)
    assert _only(events, "signal.skewed").data == {"signal": "temperature"}
    assert health.read(seconds(101), temperature=20.0) == []


def test_a_robot_that_is_good_for_the_first_time_is_no_longer_in_error() -> None:
    """It began in ERROR: nothing was read yet."""
    changed = _only(Robot().read(**GOOD), "system_state.changed")
    assert (changed.data["was"], changed.data["state"]) == ("ERROR", "IDLE")


def test_signals_whose_view_changed_are_named() -> None:
    health = Robot()
    health.read(estop=False)
    outputs = health.last
    assert outputs.signals == {"estop"}
    assert not outputs.system_state, "one reason less, and the same errors"


def test_a_task_makes_an_idle_robot_a_running_one(health: Robot) -> None:
    health.driving.status = TaskStatus.RUNNING_TASK
    changed = _only(health.read(**GOOD), "system_state.changed")

    assert (changed.data["was"], changed.data["state"]) == ("IDLE", "RUNNING")


def test_a_task_that_pauses_is_told_though_the_robot_goes_on_running(health: Robot) -> None:
    health.driving.status = TaskStatus.RUNNING_TASK
    health.read(**GOOD)
    health.driving.status = TaskStatus.PAUSED_TASK

    assert health.read(**GOOD) == []
    assert health.last.system_state


def test_a_reading_that_releases_a_stop_is_in_the_audit_trail(health: Robot) -> None:
    health.read(**{**GOOD, "estop": True})
    assert "audit.write" not in [event.kind for event in health.events.values()]

    events = health.read(estop=False)

    (written,) = [event for event in events if event.kind == "audit.write"]
    assert written.data == {
        "method": "READING",
        "path": "/signals/estop",
        "status": 200,
        "address": "test",
    }
    assert health.root(written) == "signal.read"


def test_a_reading_that_releases_nothing_is_not(health: Robot) -> None:
    health.read(**GOOD)

    assert [event.kind for event in health.read(estop=False)] == []


# --- over a restart ------------------------------------------------------------------------------


HOT = KeptError("temperature", "TEMPERATURE_HIGH", seconds(3), "temperature 60 °C is above 55 °C")


def waiting_settings() -> tuple[SignalSettings, ...]:
    """Return the signals, of which the temperature waits for an acknowledgement."""
    return tuple(
        replace(item, recovery=Recovery.ACKNOWLEDGE) if item.spec.name == "temperature" else item
        for item in default_signals()
    )


def kept_by(robot: Robot) -> list[tuple[str, KeptError | None]]:
    return [(item.name, cast("KeptError | None", item.value)) for item in robot.last.kept]


@pytest.fixture
def waiting() -> Robot:
    robot = Robot(waiting_settings())
    robot.read(**GOOD)
    robot.now = seconds(3)
    return robot


def test_an_error_is_kept_from_when_it_waits_until_it_is_acknowledged(waiting: Robot) -> None:
    waiting.read(temperature=60.0)
    assert kept_by(waiting) == [("TEMPERATURE_HIGH", HOT)]

    waiting.read(temperature=61.0)
    waiting.read(temperature=20.0)
    assert kept_by(waiting) == [], "what was measured first is kept"

    waiting.acknowledge("TEMPERATURE_HIGH")
    assert kept_by(waiting) == [("TEMPERATURE_HIGH", None)]


def test_errors_of_one_step_are_kept_in_the_order_of_their_signals() -> None:
    """Not in that of a set of names, which differs from process to process."""
    names = [f"motor_{letter}" for letter in "hgfedcba"]
    further = tuple(
        SignalSettings(
            SignalSpec(name, SignalKind.NUMBER),
            (Bound(f"{name.upper()}_HOT", Comparison.ABOVE, 80.0),),
            recovery=Recovery.ACKNOWLEDGE,
        )
        for name in names
    )
    robot = Robot((*default_signals(), *further))

    robot.read(**dict.fromkeys(names, 90.0))

    kept = [name for name, _ in kept_by(robot)]
    assert kept == [f"{name.upper()}_HOT" for name in sorted(names)]


def test_an_error_that_clears_by_itself_is_not_kept(waiting: Robot) -> None:
    waiting.read(battery_level=0.42)

    assert kept_by(waiting) == []


def test_an_error_whose_cause_comes_back_waits_again_and_is_kept_again(waiting: Robot) -> None:
    waiting.read(temperature=60.0)
    waiting.acknowledge("TEMPERATURE_HIGH")
    assert kept_by(waiting) == [("TEMPERATURE_HIGH", None)]
    waiting.read(temperature=20.0)
    waiting.pass_time(1.0)
    waiting.read(temperature=62.0)

    ((_, kept),) = kept_by(waiting)
    assert kept is not None
    assert (kept.since, kept.message) == (seconds(4), "temperature 62 °C is above 55 °C")


def test_after_a_restart_an_error_waits_before_anything_is_read() -> None:
    robot = Robot(waiting_settings(), seconds(9))
    events = robot.restore(HOT)

    assert _kinds(events) == ["service.restored", "error.raised", "system_state.changed"]
    assert _only(events, "error.raised").cause == events[0].id
    assert "TEMPERATURE_HIGH" in robot.health.errors
    assert robot.health.signal("temperature").needs_acknowledgement
    (reason,) = [item for item in robot.health.reasons if item.code == HOT.error]
    assert reason.since == HOT.since
    assert HOT.message in reason.message
    assert kept_by(robot) == [], "it is kept already"


def test_a_good_reading_does_not_end_an_error_of_an_earlier_run() -> None:
    robot = Robot(waiting_settings(), seconds(9))
    robot.restore(HOT)
    robot.read(**GOOD)
    assert list(robot.health.errors) == ["TEMPERATURE_HIGH"]

    events = robot.acknowledge("TEMPERATURE_HIGH")
    assert "error.cleared" in _kinds(events)
    assert kept_by(robot) == [("TEMPERATURE_HIGH", None)]
    assert list(robot.health.errors) == []


def test_an_error_of_an_earlier_run_can_be_acknowledged_before_anything_is_read() -> None:
    robot = Robot(waiting_settings(), seconds(9))
    robot.restore(HOT)
    robot.acknowledge("TEMPERATURE_HIGH")

    assert robot.health.errors == ("STALE_DATA",)


def test_an_error_from_a_time_to_come_is_of_now() -> None:
    robot = Robot(waiting_settings(), seconds(1))
    robot.restore(HOT)

    assert [item.since for item in robot.health.reasons if item.code == HOT.error] == [seconds(1)]


@pytest.mark.parametrize(
    ("kept", "reason"),
    [
        (
            KeptError("tilt", "TILTED", 3, "tilt 9 ° is above 5 °"),
            "there is no signal tilt any more",
        ),
        (
            KeptError("battery_level", "BATTERY_LOW", 3, "battery 42 % is below 50 %"),
            "battery_level has no such error to acknowledge any more",
        ),
    ],
    ids=["no such signal", "it clears by itself now"],
)
def test_an_error_that_is_not_there_any_more_is_left_out_and_told(
    kept: KeptError, reason: str
) -> None:
    robot = Robot(waiting_settings())
    events = robot.restore(kept, HOT)

    told = _only(events, "service.not_restored")
    assert told.data == {"what": f"the error {kept.error}", "reason": reason}
    assert kept_by(robot) == [(kept.error, None)], "it is no longer kept"
    assert "TEMPERATURE_HIGH" in robot.health.errors
