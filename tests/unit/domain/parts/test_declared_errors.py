"""What a declaration says about an error."""

import pytest

from domain.conditions.condition import Condition
from domain.parts.declared_errors import DeclaredError
from domain.snapshot import ErrorKey, Severity
from domain.state_and_mode import PartName

CAUSE = ErrorKey(PartName("lidar"), "SILENT")


@pytest.mark.parametrize(
    "own",
    [
        DeclaredError(when=Condition("not lidar.reachable")),
        DeclaredError(unless=Condition("estop")),
        DeclaredError(for_=1),
        DeclaredError(clear_for=1),
        DeclaredError(after=1),
        DeclaredError(need_all=True),
    ],
)
def test_how_it_is_found_or_follows_is_more_than_what_it_means(own: DeclaredError) -> None:
    assert own.says_how


@pytest.mark.parametrize(
    "own",
    [
        DeclaredError(),
        DeclaredError(caused_by=(CAUSE,), severity=Severity.URGENT),
        DeclaredError(hint="look at the cable", message="no scans", needs_acknowledgement=True),
        DeclaredError(suppressed_when=Condition("estop"), expected_within=1),
    ],
)
def test_what_it_means_and_what_explains_it_is_not_how(own: DeclaredError) -> None:
    assert not own.says_how
