"""What is said when something is refused."""

import inspect
import re
from collections.abc import Iterator

import pytest

from domain import errors
from domain.errors import (
    BackendUnavailableError,
    BlockedError,
    FarStartError,
    IllegalTransitionError,
    InvalidModelError,
    InvalidValueError,
    OutdatedReadingError,
    PilothouseError,
    ReservedHoldError,
    TooManyHoldsError,
    UnknownModeError,
    UnknownNameError,
    UnknownPartError,
    near_match,
)
from domain.findings import Blocker, Finding
from domain.lifecycle import LifecycleState, Transition


def _tree(cls: type[PilothouseError]) -> Iterator[type[PilothouseError]]:
    yield cls
    for child in cls.__subclasses__():
        yield from _tree(child)


def _drawn() -> dict[str, str | None]:
    """Read the tree that the module draws: each class and the class above it."""
    parents: dict[str, str | None] = {}
    trail: list[tuple[int, str]] = []
    for line in inspect.getdoc(errors).splitlines():  # type: ignore[union-attr]
        found = re.match(r"([ |+-]*)(\w+Error)\b", line)
        if found is None:
            continue
        indent, name = len(found[1]), found[2]
        while trail and trail[-1][0] >= indent:
            trail.pop()
        parents[name] = trail[-1][1] if trail else None
        trail.append((indent, name))
    return parents


def test_the_tree_that_the_module_draws_is_the_tree_that_it_holds() -> None:
    held = {
        cls.__name__: cls.__base__.__name__ if cls is not PilothouseError else None
        for cls in _tree(PilothouseError)
        if cls.__module__ == errors.__name__ and cls.__base__ is not None
    }
    assert _drawn() == held


def test_each_error_has_a_code_of_its_own() -> None:
    # Not those that other tests define.
    ours = ("api", "domain", "service")
    classes = [cls for cls in _tree(PilothouseError) if cls.__module__.partition(".")[0] in ours]
    codes = [cls.code for cls in classes]
    assert len(set(codes)) == len(codes)
    assert all(re.fullmatch(r"[A-Z][A-Z_]*", code) for code in codes)


def test_an_unknown_name_comes_with_the_names_that_are_known() -> None:
    error = UnknownPartError("part", "arm", ("drive_base", "manipulator"))
    assert error.message == str(error) == "there is no part 'arm'"
    assert error.name == "arm"
    assert error.hint == "known: drive_base, manipulator"


@pytest.mark.parametrize(("count", "shown", "more"), [(20, 20, False), (21, 20, True)])
def test_at_most_twenty_known_names_are_listed(count: int, shown: int, *, more: bool) -> None:
    hint = UnknownPartError("part", "arm", [f"n{i}" for i in range(count)]).hint
    assert hint is not None
    assert len(re.findall(r"n\d+", hint)) == shown
    assert hint.endswith(", ...") is more


def test_a_hint_that_is_given_is_told_instead_of_the_known_names() -> None:
    error = UnknownModeError("mode of lidar", "FAST", (), "lidar has no modes")
    assert error.hint == "lidar has no modes"


def test_where_nothing_is_known_there_is_no_hint() -> None:
    assert UnknownPartError("part", "arm", ()).hint is None


def test_an_invalid_model_tells_its_first_error_and_how_many_more_there_are() -> None:
    warning = Finding("warning", "SAME_MODE", "WEAK equals __DEFAULT__")
    findings = [warning, Finding("error", "CYCLE", "a > a"), Finding("error", "X", "other")]
    error = InvalidModelError(findings)
    assert error.message == "the model is invalid: a > a (and 1 more)"
    assert error.findings == tuple(findings)


def test_a_model_with_one_error_is_not_said_to_have_more() -> None:
    findings = [Finding("error", "CYCLE", "a > a"), Finding("warning", "Y", "odd")]
    assert InvalidModelError(findings).message == "the model is invalid: a > a"


def test_a_model_refused_for_warnings_alone_has_no_error_to_tell() -> None:
    assert InvalidModelError([Finding("warning", "Y", "odd")]).message == "the model is invalid: "


@pytest.mark.parametrize(
    ("state", "available", "message", "hint"),
    [
        (
            LifecycleState.UNCONFIGURED,
            (Transition.CONFIGURE, Transition.ACTIVATE),
            "arm is unconfigured: it cannot deactivate",
            "available: configure, activate",
        ),
        (
            None,
            (),
            "arm has parts in different states: it cannot deactivate",
            "available: nothing",
        ),
    ],
)
def test_an_illegal_transition_tells_where_the_part_is_and_what_it_can(
    state: LifecycleState | None, available: tuple[Transition, ...], message: str, hint: str
) -> None:
    error = IllegalTransitionError("arm", Transition.DEACTIVATE, state, available)
    assert (error.message, error.hint, error.available) == (message, hint, available)


def test_a_blocked_change_tells_all_that_stands_against_it() -> None:
    blockers = (Blocker("ESTOP", "e-stop is pressed", ()), Blocker("FINALIZED", "arm ended", ()))
    error = BlockedError("robot", blockers)
    assert error.message == "robot cannot be changed: e-stop is pressed; arm ended"
    assert error.blockers == blockers


def test_a_blocked_change_of_a_large_robot_names_the_first_blockers_and_counts_the_rest() -> None:
    blockers = [Blocker("UNKNOWN", f"system_{n} is unknown", ()) for n in range(1_106)]
    error = BlockedError("robot", blockers)
    assert error.message.startswith("robot cannot be changed: system_0 is unknown; system_1 is")
    assert error.message.endswith("; system_4 is unknown (and 1,101 more)")
    assert len(error.blockers) == 1_106


def test_an_outdated_reading_tells_how_far_it_is_behind() -> None:
    error = OutdatedReadingError("temperature", 0.25)
    assert error.message == "a newer reading of temperature is held; this one is 0.250 s older"
    assert error.hint == "omit the stamp, or correct the sender's clock"


def test_an_invalid_value_points_at_its_place() -> None:
    assert InvalidValueError("must be finite", "max_speed").pointer == "max_speed"
    assert InvalidValueError("must be finite").pointer == ""


def test_an_unreachable_backend_tells_why() -> None:
    assert BackendUnavailableError("no DDS").message == "the nodes cannot be reached: no DDS"


def test_a_path_that_begins_too_far_away_names_the_waypoint_to_begin_at() -> None:
    error = FarStartError(81.26, 5.0, nearest=(12, 0.349))
    assert error.message == "the path begins 81.3 m from the vehicle; at most 5 m"
    assert error.pointer == "waypoints"
    assert error.nearest == (12, 0.349)
    assert error.hint == "waypoint 12 is 0.3 m away: start there with start_index"


def test_where_no_waypoint_is_near_the_vehicle_has_to_come_closer() -> None:
    error = FarStartError(81.26, 5.0)
    assert error.nearest is None
    assert error.hint == "drive closer, or start at another waypoint with start_index"


def test_a_reserved_hold_tells_its_owner_and_what_to_do_instead() -> None:
    error = ReservedHoldError("vehicle")
    assert error.message == "only Pilothouse sets and releases the hold 'vehicle'"
    assert error.hint == "it is released with its cause; use another name, such as operator"


def test_too_many_holds_tell_how_many_there_are() -> None:
    assert TooManyHoldsError(64).message == "there are 64 holds already"


def test_what_was_probably_meant_is_named() -> None:
    error = UnknownNameError("mode", "PERFORMNCE", ["FAST", "PERFORMANCE"])

    assert error.hint == "known: FAST, PERFORMANCE; did you mean PERFORMANCE?"


def test_a_long_name_is_compared_with_nothing() -> None:
    assert near_match("a/" * 30_000, ["a/a/a"] * 10_000) is None
