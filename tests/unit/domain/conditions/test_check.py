"""What is wrong in a condition before it is ever evaluated."""

import pytest

from domain.conditions.check import check
from domain.conditions.condition import Condition
from domain.conditions.vocabulary import Kind, PartTerms, Terms, Vocabulary
from domain.snapshot import SystemState, TaskStatus

NUMBER, BOOLEAN, WORD = Terms(Kind.NUMBER), Terms(Kind.BOOLEAN), Terms(Kind.WORD)
PARTS = {
    "drive_base": PartTerms(
        is_node=True,
        modes=("__DEFAULT__", "SLOW", "FAST"),
        parameters={"max_speed": NUMBER, "controller": WORD, "brake": BOOLEAN, "gains": None},
        errors=("UNREACHABLE", "SILENT"),
    ),
    "left/arm": PartTerms(is_node=True),
    "camera": PartTerms(is_node=True, modes=("__DEFAULT__", "2", "true")),
    "actuation": PartTerms(is_node=False, modes=("__DEFAULT__", "PERFORMANCE")),
}
SIGNALS = {
    "battery_level": Terms(Kind.NUMBER, 0.0, 1.0),
    "temperature": NUMBER,
    "estop": BOOLEAN,
    "signal_strength": Terms(Kind.WORD, words=("CONNECTED", "LOW_SIGNAL", "NOT_CONNECTED")),
    "scan rate": Terms(Kind.NUMBER, 0.0),
}
ROBOT = Vocabulary(PARTS, SIGNALS, ("BATTERY_LOW", "ESTOP", "GPS_LOST"))


@pytest.mark.parametrize(
    "text",
    [
        "battery_level >= 0.3 and signal_strength == CONNECTED",
        "drive_base.state == active or drive_base.mode in [SLOW, FAST]",
        "part('left/arm').reachable and actuation.converged",
        "drive_base.parameters.max_speed <= 1 and drive_base.parameters.controller == PID",
        "drive_base.parameters.brake",
        "error.GPS_LOST or not error.ESTOP or drive_base.errors.SILENT",
        "robot.state != ERROR and task.status == RUNNING_TASK and task.progress > 0.5",
        "vehicle.speed_mps < 0.05 and not hold.anybody",
        "signal('scan rate') > 5 and estop == false and not estop",
        "true or false",
    ],
)
def test_everything_that_the_robot_has_can_be_named(text: str) -> None:
    assert check(Condition(text), ROBOT) == []


@pytest.mark.parametrize(
    ("text", "code", "column", "message"),
    [
        ("batery_level > 1", "UNKNOWN_SIGNAL", 1, "'batery_level'; did you mean battery_level?"),
        ("estop and speed > 1", "UNKNOWN_SIGNAL", 11, "unknown signal 'speed'"),
        ("drive.state == active", "UNKNOWN_PART", 1, "unknown part 'drive'"),
        ("part('left/am').reachable", "UNKNOWN_PART", 1, "did you mean left/arm?"),
        ("error.GPS_LOS", "UNKNOWN_ERROR", 1, "did you mean GPS_LOST?"),
        ("drive_base.errors.SILNT", "UNKNOWN_ERROR", 1, "error of drive_base 'SILNT'"),
        ("nobody.errors.SILENT", "UNKNOWN_PART", 1, "unknown part 'nobody'"),
        ("drive_base.mode == SLOV", "UNKNOWN_MODE", 20, "'SLOV'; did you mean SLOW?"),
        ("drive_base.mode in [SLOW, X]", "UNKNOWN_MODE", 27, "one of __DEFAULT__, SLOW, FAST"),
        ("part('left/arm').mode == A", "UNKNOWN_MODE", 1, "left/arm has no modes"),
        ("drive_base.state == actve", "UNKNOWN_STATE", 21, "did you mean active?"),
        ("signal_strength == HIGH", "UNKNOWN_WORD", 20, "it is one of CONNECTED"),
        ("robot.state == BROKEN", "UNKNOWN_WORD", 16, "it is one of IDLE, RUNNING, ERROR"),
        ("drive_base.state == 3", "WRONG_TYPE", 21, "drive_base.state is a word, and 3 is not"),
        ("battery_level == LOW", "WRONG_TYPE", 18, "is a number, and LOW is not"),
        ("battery_level == true", "WRONG_TYPE", 18, "is a number, and true is not"),
        ("camera.mode == 2", "WRONG_TYPE", 16, "and 2 is not; write '2' in quotes"),
        ("camera.mode == true", "WRONG_TYPE", 16, "write 'true' in quotes"),
        ("estop == 1", "WRONG_TYPE", 10, "is true or false, and 1 is not"),
        ("estop in [true, yes]", "WRONG_TYPE", 17, "is true or false, and yes is not"),
        ("estop > false", "WRONG_TYPE", 9, "estop is true or false, which has no order"),
        ("drive_base.mode < FAST", "WRONG_TYPE", 19, "is a word, which has no order"),
        ("battery_level", "WRONG_TYPE", 1, "battery_level is a number: compare it with one"),
        ("not drive_base.mode", "WRONG_TYPE", 5, "is a word: compare it with one"),
        ("drive_base", "WRONG_TYPE", 1, "drive_base is a part: name one of its facts"),
        ("drive_base.parameters.gains == 1", "WRONG_TYPE", 1, "an array, which cannot be"),
        ("actuation.parameters.x == 1", "UNKNOWN_PARAMETER", 1, "only nodes have parameters"),
        ("battery_level in []", "EMPTY_LIST", 18, "the list is empty"),
    ],
)
def test_what_can_never_be_meant_is_an_error(
    text: str, code: str, column: int, message: str
) -> None:
    (fault,) = check(Condition(text), ROBOT)

    assert (fault.severity, fault.code, fault.column) == ("error", code, column)
    assert message in fault.message


@pytest.mark.parametrize(
    ("text", "code", "column", "message"),
    [
        ("battery_level >= 30", "NEVER_TRUE", 18, "battery_level is from 0 to 1"),
        ("battery_level > 1", "NEVER_TRUE", 17, "never true"),
        ("battery_level < 0", "NEVER_TRUE", 17, "never true"),
        ("battery_level <= -1", "NEVER_TRUE", 18, "never true"),
        ("battery_level == 2", "NEVER_TRUE", 18, "never true"),
        ("battery_level in [0.5, 2]", "NEVER_TRUE", 24, "never true"),
        ("battery_level >= 0", "ALWAYS_TRUE", 18, "always true"),
        ("battery_level > -1", "ALWAYS_TRUE", 17, "always true"),
        ("battery_level <= 1", "ALWAYS_TRUE", 18, "always true"),
        ("battery_level < 2", "ALWAYS_TRUE", 17, "always true"),
        ("battery_level != 2", "ALWAYS_TRUE", 18, "always true"),
        ("signal('scan rate') < 0", "NEVER_TRUE", 23, "signal('scan rate') is at least 0"),
        ("task.progress > 50", "NEVER_TRUE", 17, "task.progress is from 0 to 1"),
        ("drive_base.state == unknown", "NEVER_KNOWN", 21, "while the state is unknown"),
        ("drive_base.parameters.max_sped < 1", "UNKNOWN_PARAMETER", 1, "did you mean max_speed?"),
    ],
)
def test_what_is_probably_not_meant_is_a_warning(
    text: str, code: str, column: int, message: str
) -> None:
    (fault,) = check(Condition(text), ROBOT)

    assert (fault.severity, fault.code, fault.column) == ("warning", code, column)
    assert message in fault.message


@pytest.mark.parametrize("text", ["battery_level <= 0", "battery_level >= 1", "temperature < -99"])
def test_a_limit_that_can_be_reached_is_fine(text: str) -> None:
    assert check(Condition(text), ROBOT) == []


def test_without_the_robot_file_unknown_signals_and_errors_are_warnings() -> None:
    model_only = Vocabulary(PARTS, SIGNALS, ROBOT.errors, is_complete=False)

    faults = check(Condition("map_age_s > 1 and error.MAP_OLD and part('x').reachable"), model_only)

    assert [(fault.severity, fault.code) for fault in faults] == [
        ("warning", "UNKNOWN_SIGNAL"),
        ("warning", "UNKNOWN_ERROR"),
        ("error", "UNKNOWN_PART"),
    ]


def test_all_faults_are_told_at_once_from_left_to_right() -> None:
    faults = check(Condition("estop == 1 or x or not (battery_level > 7 and y)"), ROBOT)

    assert [fault.column for fault in faults] == [10, 15, 41, 47]


def test_the_words_of_robot_and_task_are_those_that_they_have() -> None:
    for words, subject in ((SystemState, "robot.state"), (TaskStatus, "task.status")):
        for word in words:
            assert check(Condition(f"{subject} == {word}"), ROBOT) == []
