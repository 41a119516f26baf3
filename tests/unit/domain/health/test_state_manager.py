import math
from dataclasses import replace

import pytest

from domain.errors import (
    InvalidValueError,
    OutdatedReadingError,
    PilothouseError,
    UnknownErrorNameError,
    UnknownSignalError,
)
from domain.health.health_changes import HealthChanges
from domain.health.signals import (
    STALE_DATA,
    Bound,
    Comparison,
    Recovery,
    SignalKind,
    SignalSettings,
    SignalSpec,
    default_signals,
)
from domain.health.state_manager import StateManager
from domain.inputs import Reading
from domain.snapshot import ErrorKey, SystemState, TaskStatus
from domain.timebase import seconds
from tests.support.health_story import START, Robot, never_stale


def with_recovery(*signals: str) -> list[SignalSettings]:
    acknowledge = Recovery.ACKNOWLEDGE
    return [
        replace(item, recovery=acknowledge) if item.spec.name in signals else item
        for item in never_stale()
    ]


@pytest.fixture
def robot() -> Robot:
    """Return a robot that is well, and whose signals never grow stale."""
    robot = Robot(never_stale())
    robot.be_well(0)
    return robot


# --- state ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("status", "state"),
    [
        (TaskStatus.NO_TASK, SystemState.IDLE),
        (TaskStatus.PAUSED_TASK, SystemState.RUNNING),
        (TaskStatus.RUNNING_TASK, SystemState.RUNNING),
    ],
)
def test_a_healthy_robot_runs_while_it_has_a_task(
    robot: Robot, status: TaskStatus, state: SystemState
) -> None:
    view = robot.health.system_state(status)

    assert (view.state, view.error_code, view.reasons) == (state, 0, ())


@pytest.mark.parametrize("status", TaskStatus)
def test_an_error_outranks_any_task(robot: Robot, status: TaskStatus) -> None:
    robot.read(1, battery_level=0.42)

    assert robot.health.system_state(status).state is SystemState.ERROR


def test_errors_are_told_in_the_order_of_their_bits(robot: Robot) -> None:
    robot.read(1, temperature=60.0, estop=True, battery_level=0.42)

    view = robot.health.system_state(TaskStatus.NO_TASK)
    assert view.errors == ("BATTERY_LOW", "ESTOP", "TEMPERATURE_HIGH")
    assert view.error_code == 35


def test_stale_data_comes_after_what_was_read_last() -> None:
    robot = Robot(default_signals())
    robot.read(0, temperature=60.0)

    view = robot.health.system_state(TaskStatus.NO_TASK)
    assert (view.errors, view.error_code) == (("TEMPERATURE_HIGH", STALE_DATA), 96)


# --- reasons -------------------------------------------------------------------------------------


def test_reasons_name_the_stop_first_and_what_is_merely_kept_on_last(robot: Robot) -> None:
    robot.read(1, battery_level=0.42, temperature=60.0, estop=True)
    robot.read(1.1, battery_level=0.9)

    assert robot.words == [
        "e-stop is pressed (source pad)",
        "temperature 60 °C is above 55 °C",
        "battery no longer causes BATTERY_LOW, which stays active for at least 0.2 s",
    ]


def test_a_reason_carries_its_facts(robot: Robot) -> None:
    ((_, reason),) = robot.read(1, battery_level=0.42).raised

    assert (reason.code, reason.path, reason.value, reason.threshold, reason.since) == (
        "BATTERY_LOW",
        ("battery_level",),
        0.42,
        0.5,
        START + seconds(1),
    )


def test_every_silent_signal_is_named() -> None:
    robot = Robot(default_signals())
    robot.read(0, battery_level=1.0, gps_accuracy=100.0, signal_strength="CONNECTED")
    robot.pass_time(2.5)

    assert robot.errors == (STALE_DATA,)
    assert robot.words == [
        "no reading of battery_level for 2 s",
        "no reading of estop yet",
        "no reading of gps_accuracy for 2 s",
        "no reading of signal_strength for 2 s",
        "no reading of temperature yet",
    ]


def test_a_reason_follows_the_value(robot: Robot) -> None:
    robot.read(1, battery_level=0.42)
    changes = robot.read(2, battery_level=0.41)

    assert changes.raised == ()
    assert changes.state_changed
    assert robot.words == ["battery 41 % is below 50 %"]


# --- the emergency stop and its sources ----------------------------------------------------------


def test_no_reading_releases_the_emergency_stop(robot: Robot) -> None:
    robot.engage(1)
    robot.read(2, estop=False)
    assert robot.words == ["emergency stop is engaged"]

    robot.engage(3, engaged=False)
    assert not robot.errors


def test_releasing_the_emergency_stop_does_not_release_a_pressed_button(robot: Robot) -> None:
    robot.read(1, estop=True, source="api")
    robot.engage(2)
    assert robot.words == ["emergency stop is engaged", "e-stop is pressed (source api)"]

    robot.engage(3, engaged=False)
    assert robot.words == ["e-stop is pressed (source api)"]


def test_one_source_cannot_release_the_stop_of_another(robot: Robot) -> None:
    robot.read(1, estop=True, source="relay")
    robot.read(2, estop=False, source="pad")
    assert robot.errors == ("ESTOP",)

    robot.read(3, estop=False, source="relay")
    assert not robot.errors


def test_a_pulse_of_the_stop_within_one_message_is_seen(robot: Robot) -> None:
    robot.take(1, Reading("estop", True), Reading("estop", False))
    robot.health.pass_time(START + seconds(1.2) - 1)
    assert robot.errors == ("ESTOP",)

    assert robot.pass_time(1.2).cleared == (ErrorKey(None, "ESTOP"),)


# --- acknowledgement -----------------------------------------------------------------------------


def test_a_stop_that_has_to_be_acknowledged_outlasts_its_release() -> None:
    robot = Robot(with_recovery("estop"))
    robot.engage(1)
    robot.engage(2, engaged=False)
    assert robot.words == ["e-stop no longer causes ESTOP, which waits for acknowledgement"]
    assert robot.health.wake_at() is None

    assert robot.acknowledge(9, "ESTOP").cleared == (ErrorKey(None, "ESTOP"),)


def test_a_stop_acknowledged_while_pressed_ends_when_it_is_released() -> None:
    robot = Robot(with_recovery("estop"))
    robot.read(1, estop=True)
    assert robot.acknowledge(2, "ESTOP").cleared == ()

    assert robot.read(3, estop=False).cleared == (ErrorKey(None, "ESTOP"),)


def test_acknowledging_one_error_leaves_the_others() -> None:
    robot = Robot(with_recovery("estop", "battery_level"))
    robot.read(1, estop=True, battery_level=0.4)
    robot.read(2, estop=False, battery_level=0.9)
    robot.acknowledge(3, "BATTERY_LOW")

    assert robot.errors == ("ESTOP",)


@pytest.mark.parametrize("error", ["BATTERY_LOW", STALE_DATA])
def test_acknowledging_what_is_not_on_changes_nothing(robot: Robot, error: str) -> None:
    assert robot.acknowledge(1, error) == HealthChanges()


def test_an_error_that_does_not_exist_cannot_be_acknowledged(robot: Robot) -> None:
    with pytest.raises(UnknownErrorNameError) as refusal:
        robot.acknowledge(1, "BATTERY_FULL")

    assert refusal.value.name == "BATTERY_FULL"
    assert refusal.value.message == "there is no error 'BATTERY_FULL'"
    assert refusal.value.hint is not None
    assert refusal.value.hint.startswith("known: BATTERY_LOW, ESTOP, ")


# --- what is told --------------------------------------------------------------------------------


def test_a_bad_time_is_told_when_it_begins_and_when_it_becomes_an_error(robot: Robot) -> None:
    begun = robot.read(1, gps_accuracy=250.0)
    assert begun.pending == (("gps_accuracy", "GPS_LOST"),)
    assert not begun.state_changed

    raised = robot.pass_time(15)
    assert [key.error for key, _ in raised.raised] == ["GPS_LOST"]
    assert (raised.pending, raised.settled) == ((), ())
    assert raised.signals == {"gps_accuracy"}
    assert robot.words == ["GPS accuracy 250 mm is above 200 mm, no good reading for 15 s"]


def test_a_bad_time_that_ends_well_is_told_too(robot: Robot) -> None:
    robot.read(1, gps_accuracy=250.0)

    assert robot.read(2, gps_accuracy=100.0).settled == (("gps_accuracy", "GPS_LOST", False),)


def test_an_error_due_long_ago_is_told_with_its_own_time(robot: Robot) -> None:
    robot.read(1, gps_accuracy=250.0)
    changes = robot.read(60, gps_accuracy=100.0)

    assert [reason.since for _, reason in changes.raised] == [START + seconds(15)]
    assert changes.cleared == (ErrorKey(None, "GPS_LOST"),)


def test_what_is_due_at_an_instant_comes_before_what_arrives_at_it(robot: Robot) -> None:
    robot.read(1, gps_accuracy=250.0)
    robot.read(15, gps_accuracy=100.0)

    assert robot.errors == ("GPS_LOST",)


def test_a_second_silent_signal_is_a_new_reason_and_no_new_error() -> None:
    robot = Robot(default_signals())
    robot.be_well(0)
    robot.read(0.5, temperature=20.0)
    robot.pass_time(2.1)
    changes = robot.pass_time(2.6)

    assert (changes.raised, changes.cleared, changes.state_changed) == ((), (), True)


def test_a_clock_that_goes_wrong_is_told_once(robot: Robot) -> None:
    told = [
        robot.take(at_s, Reading("temperature", 20.0, START + seconds(at_s + ahead_s))).skewed
        for at_s, ahead_s in ((1, 0.5), (2, 1.5), (3, 1.5), (4, 0.0), (5, 1.5))
    ]

    assert told == [(), ("temperature",), (), (), ("temperature",)]


def test_the_signals_are_the_same_object_until_one_changes(robot: Robot) -> None:
    before = robot.health.signals()
    assert robot.pass_time(5) == HealthChanges()
    assert robot.health.signals() is before

    robot.read(6, temperature=21.0)
    after = robot.health.signals()
    assert {name for name in after if after[name] is not before[name]} == {"temperature"}
    assert robot.health.signal("temperature") is after["temperature"]


# --- refusals ------------------------------------------------------------------------------------

REFUSALS: list[tuple[Reading, type[PilothouseError]]] = [
    (Reading("fuel", 1.0), UnknownSignalError),
    (Reading("temperature", math.nan), InvalidValueError),
    (Reading("estop", 2.0), InvalidValueError),
    (Reading("temperature", 19.0, START - 1), OutdatedReadingError),
]


@pytest.mark.parametrize(("refused", "error"), REFUSALS)
def test_of_several_readings_all_are_taken_or_none(
    robot: Robot, refused: Reading, error: type[PilothouseError]
) -> None:
    robot.take(1, Reading("temperature", 20.0, START))
    before = robot.health.signals()

    with pytest.raises(error):
        robot.take(2, Reading("estop", True), refused)
    assert not robot.errors
    assert robot.health.signals() is before


def test_a_reading_that_an_earlier_one_of_the_same_message_outdates_is_refused(
    robot: Robot,
) -> None:
    with pytest.raises(OutdatedReadingError) as refusal:
        robot.take(1, Reading("temperature", 20.0, START), Reading("temperature", 19.0, START - 1))

    assert "temperature" in refusal.value.message


def test_pressing_the_stop_is_taken_however_late(robot: Robot) -> None:
    robot.take(1, Reading("estop", True, START))
    robot.take(2, Reading("estop", True, START - seconds(3600)))

    assert robot.errors == ("ESTOP",)


def test_a_signal_that_does_not_exist_cannot_be_seen(robot: Robot) -> None:
    with pytest.raises(UnknownSignalError):
        robot.health.signal("fuel")


# --- declarations --------------------------------------------------------------------------------


def bumper(name: str = "bumper", error: str = "BUMPED") -> SignalSettings:
    bound = Bound(error, Comparison.EQUAL, threshold=True)
    return SignalSettings(SignalSpec(name, SignalKind.BOOLEAN), (bound,), stale_after=0)


def test_declared_errors_share_a_bit_and_keep_their_names() -> None:
    robot = Robot([bumper(), bumper("tail_bumper", "TAIL_BUMPED"), *never_stale()])
    robot.read(1, bumper=True, tail_bumper=True, battery_level=0.4)

    view = robot.health.system_state(TaskStatus.NO_TASK)
    assert view.errors == ("BATTERY_LOW", "BUMPED", "TAIL_BUMPED")
    assert view.error_code == 1 + 128


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ([*default_signals(), bumper("estop")], "signal estop is declared twice"),
        ([*default_signals(), bumper(error="ESTOP")], "error ESTOP is declared twice"),
        ([*default_signals(), bumper(error=STALE_DATA)], "error STALE_DATA is declared twice"),
        ([bumper()], "signal estop is not declared"),
    ],
)
def test_a_contradictory_declaration_is_refused(
    settings: list[SignalSettings], message: str
) -> None:
    with pytest.raises(InvalidValueError, match=message):
        StateManager(settings, START)


# --- the start -----------------------------------------------------------------------------------


def test_a_robot_that_nobody_has_heard_of_is_in_error() -> None:
    robot = Robot(default_signals())

    assert robot.errors == (STALE_DATA,)
    assert robot.health.wake_at() is None


def test_a_robot_that_is_heard_at_the_start_is_well_at_once() -> None:
    robot = Robot(default_signals())
    robot.be_well(0)

    assert not robot.errors


def test_a_robot_that_is_heard_again_stays_in_error_for_the_least_time() -> None:
    robot = Robot(default_signals())
    robot.be_well(0)
    robot.pass_time(2.1)
    robot.be_well(2.1)
    assert robot.errors == (STALE_DATA,)

    robot.pass_time(2.21)
    assert not robot.errors


def test_a_signal_that_is_not_declared_is_told_with_those_that_are(robot: Robot) -> None:
    with pytest.raises(UnknownSignalError) as unknown:
        robot.read(1, wind_speed=3.0)

    assert unknown.value.message == "there is no signal 'wind_speed'"
    assert unknown.value.hint is not None
    assert unknown.value.hint.startswith("known: battery_level, estop, ")


def test_an_unfit_declaration_points_at_the_signal() -> None:
    for settings, pointer in (
        ([*default_signals(), bumper("estop")], "estop"),
        ([*default_signals(), bumper(error="ESTOP")], "ESTOP"),
        ([bumper()], "estop"),
    ):
        with pytest.raises(InvalidValueError) as refused:
            StateManager(settings, START)
        assert refused.value.pointer == pointer
