import pytest

from domain.conditions.condition import Condition
from domain.errors import InvalidModelError
from domain.parts.declared_errors import DeclaredError
from domain.parts.errors_check import error_circles, named_errors
from domain.parts.system_model import NodeModel, SmhModel
from domain.snapshot import ErrorKey, Severity
from domain.state_and_mode import PartName

A, B = PartName("a"), PartName("b")
A_LOW, B_LOW = ErrorKey(A, "LOW"), ErrorKey(B, "LOW")


def places(of_a: DeclaredError, of_b: DeclaredError) -> list[tuple[str, ...]]:
    return [finding.path for finding in error_circles({A: {"LOW": of_a}, B: {"LOW": of_b}})]


def test_errors_that_depend_in_one_direction_are_fine() -> None:
    assert places(DeclaredError(), DeclaredError(caused_by=(A_LOW,))) == []


def test_a_condition_names_errors_of_parts_and_of_the_robot() -> None:
    condition = Condition("a.errors.LOW or not (error.GPS_LOST and a.errors.LOW)")

    assert named_errors(condition) == (A_LOW, ErrorKey(None, "GPS_LOST"))


@pytest.mark.parametrize(
    ("of_b", "place"),
    [
        (DeclaredError(caused_by=(A_LOW,)), ("b", "errors", "LOW", "caused_by", "a.LOW")),
        (DeclaredError(when=Condition("a.errors.LOW")), ("b", "errors", "LOW", "when")),
        (
            DeclaredError(caused_by=(ErrorKey(None, "X"),), unless=Condition("a.errors.LOW")),
            ("b", "errors", "LOW", "unless"),
        ),
    ],
)
def test_a_circle_is_told_where_a_file_can_open_it(
    of_b: DeclaredError, place: tuple[str, ...]
) -> None:
    of_c = {"LOW": DeclaredError(caused_by=(B_LOW,))}
    of_a = DeclaredError(caused_by=(ErrorKey(PartName("c"), "LOW"),))

    (finding,) = error_circles({B: {"LOW": of_b}, A: {"LOW": of_a}, PartName("c"): of_c})
    assert finding.path == place
    assert finding.message == "b.LOW depends on itself: b.LOW < a.LOW < c.LOW < b.LOW"


@pytest.mark.parametrize(
    "condition", ["robot.state == IDLE", "task.status == RUNNING_TASK", "hold('error')"]
)
def test_a_severe_error_does_not_rest_on_what_follows_from_it(condition: str) -> None:
    resting = DeclaredError(when=Condition(condition), severity=Severity.WARNING)
    severe = DeclaredError(caused_by=(B_LOW,), severity=Severity.CRITICAL)

    (finding,) = error_circles({A: {"LOW": severe}, B: {"LOW": resting}})
    assert finding.message == "a.LOW depends on itself: a.LOW < b.LOW < robot.state < a.LOW"


def test_an_error_that_changes_nothing_may_rest_on_the_state_of_the_robot() -> None:
    resting = DeclaredError(when=Condition("robot.state == ERROR"), severity=Severity.URGENT)

    assert places(resting, DeclaredError(severity=Severity.CRITICAL)) == []


def test_a_model_without_a_file_is_checked_as_well() -> None:
    nodes = {A: NodeModel(A)}
    with pytest.raises(InvalidModelError):
        SmhModel(nodes, {}, errors={A: {"LOW": DeclaredError(caused_by=(A_LOW,))}})
