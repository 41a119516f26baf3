"""Which errors parts have, and how bad each is."""

import pytest

from domain.health.built_in_errors import OF_EVERY_PART, OF_NODES, severity_of
from domain.snapshot import ErrorKey, Severity
from domain.state_and_mode import PartName

ARM = PartName("arm")


def test_a_node_has_what_every_part_has_and_more() -> None:
    assert list(OF_NODES) == [
        "UNREACHABLE",
        "ERROR_PROCESSING",
        "PARAMETERS_DRIFTED",
        "DEVIATES",
        "CHANGE_FAILED",
        "INVARIANT_BROKEN",
    ]
    assert list(OF_EVERY_PART) == ["DEVIATES", "CHANGE_FAILED", "INVARIANT_BROKEN"]


@pytest.mark.parametrize("error", OF_NODES)
def test_no_built_in_error_sets_a_bit_of_the_robot(error: str) -> None:
    assert severity_of(ErrorKey(ARM, error)) in (Severity.WARNING, Severity.URGENT)


def test_errors_of_the_robot_are_critical() -> None:
    assert severity_of(ErrorKey(None, "BATTERY_LOW")) is Severity.CRITICAL
