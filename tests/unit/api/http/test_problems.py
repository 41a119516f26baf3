"""One table from our errors to statuses, and the documents that come of it."""

import importlib
import json
import pkgutil
from collections.abc import Iterator
from http import HTTPStatus

import pytest

import api
import domain
import service
from api.http.body_parsing import InvalidBodyError
from api.http.problems import STATUS_OF, make_problem, problem_of, status_of
from api.http.schemas.problem import BodyFault
from domain.errors import (
    BlockedError,
    IllegalTransitionError,
    InvalidModelError,
    InvalidValueError,
    PilothouseError,
    RefusedError,
    UnknownPartError,
)
from domain.findings import Blocker, Finding
from domain.lifecycle import LifecycleState, Transition
from tests.support.manual_clock import ManualClock

CLOCK = ManualClock()


def all_errors() -> Iterator[type[PilothouseError]]:
    """Yield every class of the tree that any of our modules defines."""
    for package in (api, domain, service):
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            # It has no errors of its own, and ROS 2 is not there where these tests run.
            if module.name != "service.ros.graph.link":
                importlib.import_module(module.name)
    waiting: list[type[PilothouseError]] = [PilothouseError]
    while waiting:
        error = waiting.pop()
        waiting += error.__subclasses__()
        # Tests may define errors, too, but not in our packages.
        if error.__module__.partition(".")[0] in ("api", "domain", "service"):
            yield error


def test_every_error_of_ours_has_a_status() -> None:
    missing = [error.__name__ for error in all_errors() if error not in STATUS_OF]

    assert missing == []


def test_every_error_of_ours_has_a_title_and_a_code_of_its_own() -> None:
    titles = [(error.__doc__ or "").partition("\n")[0] for error in all_errors()]
    codes = [error.code for error in all_errors()]

    assert all(titles)
    assert sorted(set(codes)) == sorted(codes)


def test_an_error_that_is_not_in_the_table_has_the_status_of_the_one_above() -> None:
    class NewRefusalError(RefusedError):
        """A refusal that nobody has thought of yet."""

    assert status_of(NewRefusalError("no")) is HTTPStatus.CONFLICT


def test_a_problem_tells_what_where_and_what_helps() -> None:
    error = UnknownPartError("node", "x", ["drive_base"])

    assert document(error) == {
        "type": "urn:pilothouse:problem:unknown-part",
        "title": "An unknown part: the model has no system or node of this name",
        "status": 404,
        "detail": "there is no node 'x'",
        "instance": "/nodes/x",
        "code": "UNKNOWN_PART",
        "hint": "known: drive_base",
    }


def test_what_stands_against_a_change_is_told_with_every_field() -> None:
    blocker = Blocker("ESTOP", "emergency stop is engaged", ("actuation",), since=0)

    assert document(BlockedError("actuation", [blocker]))["blockers"] == [
        {
            "code": "ESTOP",
            "message": "emergency stop is engaged",
            "path": ["actuation"],
            "value": None,
            "threshold": None,
            "since_at": "2026-01-01T00:00:00.000Z",
            "root_cause": True,
            "refuses": True,
            "causes": [],
            "condition": None,
        }
    ]


def test_an_illegal_transition_comes_with_those_that_are_legal() -> None:
    error = IllegalTransitionError(
        "drive_base", Transition.DEACTIVATE, LifecycleState.UNCONFIGURED, [Transition.CONFIGURE]
    )

    assert document(error)["available"] == ["configure"]


def test_an_invalid_model_comes_with_its_findings() -> None:
    finding = Finding("error", "CYCLE", "a contains itself", "a", line=1, column=2)

    found = document(InvalidModelError([finding]))["findings"]

    assert found == [
        {
            "severity": "error",
            "code": "CYCLE",
            "message": "a contains itself",
            "line": 1,
            "column": 2,
            "part": "a",
        }
    ]


@pytest.mark.parametrize(
    ("pointer", "shown"), [("speed", "/speed"), ("a/b", "/a~1b"), ("/topics", "/topics"), ("", "")]
)
def test_an_invalid_value_comes_with_its_place(pointer: str, shown: str) -> None:
    found = document(InvalidValueError("too fast", pointer))["errors"]

    assert found == [{"pointer": shown, "code": "INVALID_VALUE", "message": "too fast"}]


def test_everything_wrong_in_a_body_is_told_at_once() -> None:
    faults = [BodyFault(pointer=f"/{name}", code="MISSING", message="needed") for name in "ab"]

    found = document(InvalidBodyError(faults))

    assert found["detail"] == "/a: needed (and 1 more)"
    assert len(found["errors"]) == 2  # type: ignore[arg-type]


def test_what_does_not_apply_is_left_out() -> None:
    problem = make_problem(HTTPStatus.NOT_FOUND, "UNKNOWN_PATH", "nothing is there", "/x")

    found = json.loads(problem.as_json())

    assert set(found) == {"type", "title", "status", "detail", "instance", "code"}


def document(error: PilothouseError) -> dict[str, object]:
    found: dict[str, object] = json.loads(problem_of(error, CLOCK, "/nodes/x").as_json())
    return found
