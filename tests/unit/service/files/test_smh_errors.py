import pytest

from domain.conditions.condition import Condition
from domain.health.signals import default_signals
from domain.parts.declared_errors import DeclaredError
from domain.snapshot import ErrorKey, Severity
from domain.state_and_mode import PartName
from domain.timebase import seconds
from service.files.model_file import check_model, read_model

CARRIER, LIDAR, MAPPER = PartName("carrier"), PartName("left/lidar"), PartName("mapper")
SILENT = ErrorKey(LIDAR, "SILENT")
ROBOT = """\
carrier:
  ros__parameters:
    type: system
    modes: {__DEFAULT__: {left/lidar: active, mapper: active}}
left/lidar:
  ros__parameters: {type: node, errors: {SILENT: {when: "not part('left/lidar').reachable"}}}
mapper:
  ros__parameters:
    type: node
    errors:
%s
"""


def robot(errors: str) -> str:
    """Return a model; the text of the errors of `mapper` begins in line 11, column 7."""
    lines = errors.strip("\n").splitlines()
    return ROBOT % "\n".join(f"      {line}" for line in lines)


def read(errors: str) -> dict[str, DeclaredError]:
    return dict(read_model(robot(errors)).model.errors[MAPPER])


def told(errors: str) -> list[tuple[str, int | None, int | None]]:
    return [(f.code, f.line, f.column) for f in check_model(robot(errors))]


def test_all_that_can_be_said_of_a_detected_error_is_read() -> None:
    errors = read(
        """
LATE:
  when: "battery_level > 0.1"
  for_s: 0.5
  clear_for_s: 2
  caused_by: [left/lidar.SILENT, GPS_LOST]
  expected_within_s: 3
  severity: critical
  recovery: acknowledge
  suppressed_when: "mapper.state != active"
  message: the map is old
  hint: look at the lidar
"""
    )

    assert errors == {
        "LATE": DeclaredError(
            when=Condition("battery_level > 0.1"),
            for_=seconds(0.5),
            clear_for=seconds(2),
            caused_by=(SILENT, ErrorKey(None, "GPS_LOST")),
            expected_within=seconds(3),
            severity=Severity.CRITICAL,
            needs_acknowledgement=True,
            suppressed_when=Condition("mapper.state != active"),
            message="the map is old",
            hint="look at the lidar",
        )
    }


def test_how_an_error_follows_is_read() -> None:
    errors = read("BLIND: {caused_by: left/lidar.SILENT, need: all, after_s: 1, unless: estop}")

    assert errors["BLIND"] == DeclaredError(
        caused_by=(SILENT,), need_all=True, unless=Condition("estop"), after=seconds(1)
    )


@pytest.mark.parametrize("written", ["{severity: urgent}", "{}", ""])
def test_an_error_without_condition_and_causes_is_reported_by_others(written: str) -> None:
    severity = Severity.URGENT if "urgent" in written else None

    assert read(f"JAMMED: {written}") == {"JAMMED": DeclaredError(severity=severity)}


def test_what_is_said_of_a_built_in_error_is_its_severity_and_its_causes() -> None:
    errors = read("UNREACHABLE: {severity: fatal, caused_by: [left/lidar.SILENT], hint: check it}")

    assert errors["UNREACHABLE"] == DeclaredError(
        severity=Severity.FATAL, caused_by=(SILENT,), hint="check it"
    )


def test_dotted_names_are_read_as_nested_ones() -> None:
    assert read("LATE.severity: urgent") == read("LATE: {severity: urgent}")


def test_a_leading_slash_of_a_part_is_dropped() -> None:
    assert read("LATE: {caused_by: [/left/lidar.SILENT]}")["LATE"].caused_by == (SILENT,)


def test_conditions_can_name_declared_errors() -> None:
    text = "LATE: {when: \"part('left/lidar').errors.SILENT\"}"

    assert told(text) == []


@pytest.mark.parametrize(
    ("errors", "code", "line", "column"),
    [
        pytest.param("LATE: 5", "INVALID_VALUE", 11, 7, id="an error without keys"),
        pytest.param("Late: {severity: urgent}", "INVALID_ERROR_NAME", 11, 7, id="small letters"),
        pytest.param("1LATE: {severity: urgent}", "INVALID_ERROR_NAME", 11, 7, id="a digit first"),
        pytest.param(
            f"{'L' * 65}: {{severity: fatal}}", "INVALID_ERROR_NAME", 11, 7, id="a long name"
        ),
        pytest.param("ESTOP: {severity: warning}", "NAME_TAKEN", 11, 7, id="the emergency stop"),
        pytest.param("LATE: {wen: estop}", "UNKNOWN_KEY", 11, 14, id="an unknown key"),
        pytest.param("LATE: {wen: {x: 1, y: 2}}", "UNKNOWN_KEY", 11, 14, id="an unknown block"),
        pytest.param("LATE: {when: {x: 1}}", "INVALID_VALUE", 11, 21, id="a map for a condition"),
        pytest.param("LATE: {when: [estop]}", "INVALID_VALUE", 11, 20, id="a list of conditions"),
        pytest.param("LATE: {when: 5}", "INVALID_VALUE", 11, 20, id="a number for a condition"),
        pytest.param("LATE: {when: 'a => 1'}", "CONDITION_SYNTAX", 11, 23, id="no operator"),
        pytest.param("LATE: {when: ''}", "CONDITION_SYNTAX", 11, 21, id="an empty condition"),
        pytest.param("LATE: {when: 'estop > 1'}", "WRONG_TYPE", 11, 29, id="an order of a boolean"),
        pytest.param("LATE: {when: maper.reachable}", "UNKNOWN_PART", 11, 20, id="no such part"),
        pytest.param(
            "LATE: {caused_by: GPS_LOST, unless: mapper.mode == X}",
            "UNKNOWN_MODE",
            11,
            43,
            id="a part without modes in unless",
        ),
        pytest.param(
            "LATE: {when: estop, suppressed_when: maper.reachable}",
            "UNKNOWN_PART",
            11,
            44,
            id="no such part in suppressed_when",
        ),
        pytest.param(
            "LATE: {when: estop, for_s: -1}", "INVALID_VALUE", 11, 34, id="a negative time"
        ),
        pytest.param("LATE: {when: estop, for_s: soon}", "INVALID_VALUE", 11, 34, id="no number"),
        pytest.param(
            "LATE: {when: estop, clear_for_s: 90000}", "INVALID_VALUE", 11, 40, id="more than a day"
        ),
        pytest.param(
            "LATE: {when: estop, caused_by: [GPS_LOST], expected_within_s: 0}",
            "INVALID_VALUE",
            11,
            69,
            id="no time at all",
        ),
        pytest.param("LATE: {severity: bad}", "INVALID_VALUE", 11, 24, id="no such severity"),
        pytest.param("LATE: {recovery: never}", "INVALID_VALUE", 11, 24, id="no such recovery"),
        pytest.param(
            "LATE: {caused_by: GPS_LOST, need: some}",
            "INVALID_VALUE",
            11,
            41,
            id="neither any nor all",
        ),
        pytest.param("LATE: {message: [a, b]}", "INVALID_VALUE", 11, 23, id="several messages"),
        pytest.param(f"LATE: {{hint: {'x' * 501}}}", "TOO_LARGE", 11, 20, id="a long hint"),
        pytest.param(
            "LATE: {caused_by: [lidar]}", "INVALID_VALUE", 11, 26, id="a cause that is none"
        ),
        pytest.param(
            "LATE: {caused_by: [GPS_LOST, GPS_LOST]}", "INVALID_VALUE", 11, 36, id="a cause twice"
        ),
        pytest.param(
            "LATE: {caused_by: [lidar.SILENT]}", "UNKNOWN_PART", 11, 26, id="a cause of no part"
        ),
        pytest.param(
            "LATE: {caused_by: [LATE]}", "UNKNOWN_ERROR", 11, 26, id="no error of the robot"
        ),
        pytest.param(
            "LATE: {caused_by: [left/lidar.SILNT]}",
            "UNKNOWN_ERROR",
            11,
            26,
            id="no error of the part",
        ),
        pytest.param(
            "LATE: {caused_by: [mapper.LATE]}", "ERROR_CIRCLE", 11, 26, id="its own cause"
        ),
        pytest.param(
            "LATE: {when: mapper.errors.OLD}\nOLD: {caused_by: [mapper.LATE]}",
            "ERROR_CIRCLE",
            11,
            14,
            id="a circle through a condition",
        ),
        pytest.param(
            "LATE: {severity: critical, when: robot.state == ERROR}",
            "ERROR_CIRCLE",
            11,
            34,
            id="ERROR because of ERROR",
        ),
        pytest.param(
            "LATE: {severity: fatal, caused_by: [GPS_LOST], unless: task.status == RUNNING_TASK}",
            "ERROR_CIRCLE",
            11,
            54,
            id="a task that the error holds",
        ),
        pytest.param(
            "UNREACHABLE: {when: estop}", "BUILT_IN_ERROR", 11, 21, id="how a built-in one is found"
        ),
        pytest.param("LATE: {for_s: 1}", "NO_EFFECT", 11, 14, id="a time without a condition"),
        pytest.param("LATE: {need: all}", "NO_EFFECT", 11, 14, id="need without causes"),
        pytest.param(
            "LATE: {when: estop, after_s: 1}", "NO_EFFECT", 11, 27, id="detected, and after"
        ),
        pytest.param(
            "LATE: {caused_by: [GPS_LOST], expected_within_s: 1}",
            "NO_EFFECT",
            11,
            37,
            id="what follows anyway is expected",
        ),
        pytest.param("LATE: {severity: }", "NOT_FOR_CPP", 11, 14, id="a null"),
        pytest.param("LATE: {}", "NOT_FOR_CPP", 11, 7, id="an empty map"),
        pytest.param("LATE: {caused_by: []}", "NOT_FOR_CPP", 11, 25, id="an empty list"),
        pytest.param(
            "LATE: {severity: urgent, severity: fatal}", "DUPLICATE_KEY", 11, 32, id="a key twice"
        ),
    ],
)
def test_what_is_wrong_is_told_with_its_place(
    errors: str, code: str, line: int, column: int
) -> None:
    found = [(f.code, f.line, f.column) for f in check_model(robot(errors), default_signals())]

    assert found == [(code, line, column)]


@pytest.mark.parametrize(
    ("errors", "words"),
    [
        ("LATE: {wen: estop}", "did you mean when?"),
        ("LATE: {xyz: 1}", "known: when, for_s, clear_for_s, caused_by"),
        ("LATE: {severity: urgnt}", "did you mean urgent?"),
        ("LATE: {caused_by: [left/lidar.SILNT]}", "did you mean SILENT?"),
        ("LATE: {caused_by: [lidar]}", "write PART.ERROR, or ERROR of the robot itself"),
        ("LATE: {caused_by: [mapper.LATE]}", "mapper.LATE depends on itself"),
    ],
)
def test_what_was_probably_meant_is_told(errors: str, words: str) -> None:
    (finding,) = check_model(robot(errors))

    assert words in finding.message


def test_an_error_that_the_robot_file_may_declare_is_a_warning_without_it() -> None:
    (finding,) = check_model(robot("LATE: {caused_by: [left/lidar.SCAN_SLOW]}"))

    assert (finding.severity, finding.code) == ("warning", "UNKNOWN_ERROR")


def test_errors_that_are_no_block_are_told() -> None:
    text = ROBOT.replace("    errors:\n%s\n", "    errors: 5\n")

    assert [(f.code, f.line, f.column) for f in check_model(text)] == [("NOT_A_BLOCK", 10, 5)]


def test_a_circle_is_told_beside_other_errors() -> None:
    found = told("LATE: {caused_by: [mapper.LATE]}\nOLD: {severity: bad}")

    assert [code for code, *_ in found] == ["ERROR_CIRCLE", "INVALID_VALUE"]
