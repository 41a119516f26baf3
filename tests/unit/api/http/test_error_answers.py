"""Answers that list errors: all, those that are on, or the others."""

import json

import pytest

from api.http.error_answers import answer_errors
from domain.snapshot import ErrorState
from tests.support.frames import error_view
from tests.support.live_robot import make_supervisor

VIEWS = [
    error_view("arm", "UNREACHABLE"),
    error_view("arm", "DEVIATES", ErrorState.PENDING),
    error_view("arm", "CHANGE_FAILED", ErrorState.NORMAL),
    error_view(None, "ESTOP", ErrorState.LATCHED),
]


@pytest.mark.parametrize(
    ("active", "errors"),
    [
        (None, ["UNREACHABLE", "DEVIATES", "CHANGE_FAILED", "ESTOP"]),
        (True, ["UNREACHABLE", "ESTOP"]),
        (False, ["DEVIATES", "CHANGE_FAILED"]),
    ],
)
async def test_pending_and_normal_errors_are_not_active(
    active: bool | None,
    errors: list[str],
) -> None:
    answer = await answer_errors(make_supervisor(), VIEWS, active)
    assert [item["error"] for item in json.loads(bytes(answer.body))["items"]] == errors
