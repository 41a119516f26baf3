from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from api.simulation.expectations import MISSING, differences

SEEN: dict[str, Any] = {
    "system_state": {"state": "ERROR", "errors": ["ESTOP"], "error_code": 2},
    "parts": {
        "actuation": {"actual": {"state": "active", "mode": "FAST"}, "converged": True},
        "arm": {"actual": {"state": "inactive", "mode": None}},
    },
    "task": None,
    "vehicle": {"speed_mps": 2.8},
}

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner),
    max_leaves=8,
)


def found(expected: object, seen: object = SEEN) -> list[tuple[str, object, object]]:
    return [(item.path, item.expected, item.seen) for item in differences(expected, seen)]


@pytest.mark.parametrize(
    "expected",
    [
        {"system_state": {"state": "ERROR"}},
        {"system_state": {"errors": ["ESTOP"], "error_code": 2}},
        {"task": None},
        {"parts": {"actuation": {"actual": "active.FAST"}, "arm": {"actual": "inactive"}}},
        {"parts": {"actuation": {"actual": {"state": "active"}, "converged": True}}},
        {"vehicle": {"speed_mps": {"above": 2, "below": 3}}},
        {"vehicle": {"speed_mps": {"at_least": 2.8, "at_most": 2.8}}},
    ],
)
def test_what_is_as_expected_does_not_differ(expected: object) -> None:
    assert found(expected) == []


@pytest.mark.parametrize(
    ("expected", "path", "seen"),
    [
        ({"system_state": {"state": "IDLE"}}, "system_state.state", "ERROR"),
        ({"system_state": {"errors": []}}, "system_state.errors", ["ESTOP"]),
        ({"system_state": {"error": 2}}, "system_state.error", MISSING),
        ({"task": {"status": "RUNNING"}}, "task", None),
        (
            {"parts": {"actuation": {"actual": "active.SLOW"}}},
            "parts.actuation.actual",
            "active.FAST",
        ),
        ({"parts": {"arm": {"actual": "active"}}}, "parts.arm.actual", "inactive"),
        ({"parts": {"actuation": {"actual": "active"}}}, "parts.actuation.actual", "active.FAST"),
        ({"parts": {"actuation": {"converged": 1}}}, "parts.actuation.converged", True),
        ({"system_state": {"error_code": "2"}}, "system_state.error_code", 2),
    ],
)
def test_a_difference_is_told_with_its_place_and_what_is_seen(
    expected: object, path: str, seen: object
) -> None:
    assert [(where, saw) for where, _, saw in found(expected)] == [(path, seen)]


@pytest.mark.parametrize(
    "limits",
    [{"above": 2.8}, {"below": 2.8}, {"at_least": 2.81}, {"at_most": 2.79}],
)
def test_a_number_beyond_its_limits_differs(limits: dict[str, float]) -> None:
    expected = {"vehicle": {"speed_mps": limits}}

    assert found(expected) == [("vehicle.speed_mps", limits, 2.8)]


@pytest.mark.parametrize("seen", [True, "3", None, [3], {"above": 2}])
def test_what_is_no_number_is_within_no_limits(seen: object) -> None:
    assert found({"above": 2}, seen) == [("", {"above": 2}, seen)]


def test_limits_that_are_no_numbers_are_members_like_others() -> None:
    assert found({"above": "x"}, {"above": "x"}) == []
    assert found({"above": "x"}, 3) == [("", {"above": "x"}, 3)]


def test_all_differences_are_told() -> None:
    expected = {"system_state": {"state": "IDLE", "error_code": 0}, "task": "t1"}

    assert [where for where, _, _ in found(expected)] == [
        "system_state.state",
        "system_state.error_code",
        "task",
    ]


@given(VALUES)
def test_a_value_does_not_differ_from_itself(value: object) -> None:
    assert found(value, value) == []


@given(VALUES, VALUES)
def test_two_values_can_always_be_compared(expected: object, seen: object) -> None:
    assert isinstance(found(expected, seen), list)
