"""Why a condition is not true, in the words of an operator."""

import pytest

from domain.conditions.condition import Condition
from domain.conditions.explanation import explain
from domain.conditions.facts import Observation
from domain.findings import Blocker
from domain.timebase import seconds
from tests.support.told_facts import ToldFacts

FACTS = ToldFacts(
    {
        "battery_level": Observation(0.21, since=seconds(3)),
        "temperature": Observation(52.125, unit="°C"),
        "estop": True,
        "gps_accuracy": Observation(120.0, "is stale", seconds(5), "mm"),
        "strength": "LOW_SIGNAL",
        "drive_base.state": "inactive",
        "drive_base.mode": None,
        "drive_base.reachable": False,
        "drive_base.parameters.max_speed": 0.5,
        "arm.state": Observation(None, "is unreachable"),
        "arm.mode": "FAST",
        "arm.reachable": True,
        "arm.converged": False,
        "error.ESTOP": True,
        "error.GPS_LOST": False,
        "lidar.errors.SILENT": True,
        "robot.state": "ERROR",
        "task.status": "NO_TASK",
        "task.progress": 0.25,
        "vehicle.speed_mps": Observation(1.5, unit="m/s"),
        "hold.operator": True,
    }
)


def _why(text: str, facts: ToldFacts = FACTS) -> Blocker:
    (blocker,) = explain(Condition(text), facts)
    return blocker


def test_a_true_condition_needs_no_explanation() -> None:
    assert explain(Condition("battery_level < 0.3 or estop"), FACTS) == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("battery_level >= 0.3", "battery_level is 0.21, needs >= 0.3"),
        ("temperature < 50", "temperature is 52.125 °C, needs < 50 °C"),
        ("not estop", "estop is true, needs false"),
        ("estop == false", "estop is true, needs false"),
        ("strength == CONNECTED", "strength is LOW_SIGNAL, needs CONNECTED"),
        ("drive_base.state == active", "drive_base is inactive, needs active"),
        ("drive_base.state in [active, activating]", "is inactive, needs active or activating"),
        ("drive_base.mode == SLOW", "the mode of drive_base is none, needs SLOW"),
        ("arm.mode not in [FAST, RUN]", "mode of arm is FAST, needs anything but FAST or RUN"),
        ("drive_base.reachable", "drive_base is unreachable"),
        ("not arm.reachable", "arm is reachable"),
        ("arm.converged", "arm has not converged"),
        ("drive_base.parameters.max_speed <= 0.2", "max_speed of drive_base is 0.5, needs <= 0.2"),
        ("not error.ESTOP", "ESTOP is active"),
        ("error.GPS_LOST", "GPS_LOST is not active"),
        ("not lidar.errors.SILENT", "SILENT of lidar is active"),
        ("robot.state != ERROR", "the robot is ERROR, needs anything but ERROR"),
        ("task.status == RUNNING_TASK", "the task status is NO_TASK, needs RUNNING_TASK"),
        ("task.progress > 0.5", "the progress of the task is 0.25, needs > 0.5"),
        ("vehicle.speed_mps < 0.05", "the speed of the vehicle is 1.5 m/s, needs < 0.05 m/s"),
        ("not hold.operator", "hold operator is set"),
        ("false", "it is always false"),
    ],
)
def test_a_leaf_says_what_is_and_what_is_needed(text: str, message: str) -> None:
    blocker = _why(text)

    assert message in blocker.message
    assert (blocker.code, blocker.causes, blocker.root_cause) == ("CONDITION", (), True)
    assert blocker.condition == text
    assert blocker.refuses


def test_a_leaf_has_value_threshold_and_since_when() -> None:
    blocker = _why("battery_level >= 0.3")

    assert (blocker.value, blocker.threshold, blocker.since) == (0.21, 0.3, seconds(3))
    assert blocker.path == ("battery_level",)


def test_what_is_not_known_says_so_with_the_last_value() -> None:
    blocker = _why("gps_accuracy <= 200")

    assert blocker.code == "UNKNOWN_VALUE"
    assert blocker.message == "gps_accuracy is stale, needs <= 200 mm"
    assert (blocker.value, blocker.since) == (120.0, seconds(5))
    assert _why("arm.state == active").message == "arm is unreachable, needs active"


def test_of_and_only_the_parts_that_fail_are_shown() -> None:
    blocker = _why("battery_level < 1 and temperature < 50 and gps_accuracy < 1")

    assert blocker.code == "CONDITION"
    assert [cause.condition for cause in blocker.causes] == ["temperature < 50", "gps_accuracy < 1"]
    assert not blocker.root_cause


def test_of_or_all_parts_are_shown() -> None:
    blocker = _why("temperature < 50 or gps_accuracy < 1")

    assert blocker.code == "UNKNOWN_VALUE", "one of them may be true"
    assert blocker.message == "unknown: temperature < 50 or gps_accuracy < 1"
    assert [cause.code for cause in blocker.causes] == ["CONDITION", "UNKNOWN_VALUE"]


def test_what_is_negated_is_shown_turned_round() -> None:
    blocker = _why("not (battery_level < 0.3 or estop)")

    assert blocker.condition == "not (battery_level < 0.3 or estop)"
    assert [cause.condition for cause in blocker.causes] == ["battery_level >= 0.3", "not estop"]
    assert [cause.threshold for cause in blocker.causes] == [0.3, False]


def test_a_leaf_that_is_an_error_is_explained_by_its_reasons() -> None:
    reason = Blocker("ESTOP", "e-stop pressed by panel", ("estop",), value=True)
    facts = ToldFacts(FACTS.observed, {"not error.ESTOP": (reason,)})

    blocker = _why("not error.ESTOP", facts)

    assert blocker.causes == (reason,)
    assert not blocker.root_cause
