"""Declared signals that do not fit the model."""

import pytest

from domain.errors import InvalidValueError
from domain.health.signals import SignalSettings
from domain.snapshot import ErrorKey, Severity
from domain.state_and_mode import PartName
from service.files.robot_file import InvalidRobotFileError, read_robot_file, robot_settings_of
from tests.support.models import actuation_model

MODEL = actuation_model()


def declared(text: str) -> SignalSettings:
    return read_robot_file(text, MODEL).to_signal_settings()[-1]


def test_the_error_of_a_signal_may_be_that_of_a_part_with_a_severity() -> None:
    scan = declared(
        "signals: {scan_rate: {below: 8, error: SCAN_SLOW, part: /drive_base, severity: urgent}}"
    )
    assert (scan.part, scan.severity) == ("drive_base", Severity.URGENT)
    assert scan.value_errors == ("SCAN_SLOW",)
    assert scan.stale_key == ErrorKey(PartName("drive_base"), "SCAN_RATE_STALE")


def test_a_signal_of_which_nothing_is_said_is_critical_and_of_the_robot() -> None:
    load = declared("signals: {load: {above: 8, error: OVERLOAD}}")
    assert (load.part, load.severity) == (None, Severity.CRITICAL)
    assert load.stale_key.name == "STALE_DATA"


@pytest.mark.parametrize(
    ("text", "place", "code", "words"),
    [
        ("{a: {part: drive_bse}}", (1, 15), "UNKNOWN_PART", "did you mean drive_base?"),
        ("{a: {part: arms}}", (1, 15), "UNKNOWN_PART", "there is no part 'arms'"),
        (
            "{a: {above: 1, error: UNREACHABLE, part: drive_base}}",
            (1, 25),
            "DUPLICATE_ERROR",
            "Pilothouse itself",
        ),
        (
            "{a: {above: 1, error: A, part: actuation}, b: {above: 1, error: A, part: actuation}}",
            (1, 1),
            "INVALID_VALUE",
            "actuation.A of b is already",
        ),
        (
            "{a: {severity: warning}, b: {above: 1, error: A_STALE}}",
            (1, 1),
            "INVALID_VALUE",
            "A_STALE of b is already",
        ),
        ("{a: {severity: bad}}", (1, 15), "INVALID_VALUE", "severity"),
    ],
)
def test_what_does_not_fit_is_found_at_its_place(
    text: str, place: tuple[int, int], code: str, words: str
) -> None:
    with pytest.raises(InvalidRobotFileError) as caught:
        read_robot_file(f"signals: {text}", MODEL)
    (finding,) = caught.value.findings
    assert ((finding.line, finding.column), finding.code) == (place, code)
    assert words in finding.message


def test_in_a_simulation_it_is_found_at_its_pointer() -> None:
    with pytest.raises(InvalidValueError, match="no part 'arms'") as caught:
        robot_settings_of({"signals": {"a": {"part": "arms"}}}, MODEL)
    assert caught.value.pointer == "/signals/a/part"


def test_two_parts_may_have_errors_of_the_same_name() -> None:
    read_robot_file(
        "signals: {a: {above: 1, error: HOT, part: drive_base}, "
        "b: {above: 1, error: HOT, part: manipulator}, c: {above: 1, error: HOT}}",
        MODEL,
    )
