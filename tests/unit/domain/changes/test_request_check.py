"""Whether a request names things that exist, with values that can be right."""

import math
from collections.abc import Mapping

import pytest

from domain.actor import Actor
from domain.changes.request_check import check_request, describe_request
from domain.errors import (
    InvalidValueError,
    UnknownModeError,
    UnknownParameterError,
    UnknownPartError,
)
from domain.inputs import ChangeRequest, ModeRequest, ParametersRequest, TransitionRequest
from domain.lifecycle import Transition
from domain.parameters import ParameterValue
from domain.parts.node_facts import NodeFacts
from domain.state_and_mode import PartName
from tests.support.models import ACTUATION, ARM, BASE, actuation_model

MODEL = actuation_model()
KNOWN: Mapping[str, ParameterValue] = {
    "max_speed": 0.5,
    "controller": "PID",
    "retries": 3,
    "brake": False,
    "gains": (1.0, 2.0),
}


def _check(request: ChangeRequest, known: Mapping[str, ParameterValue] = KNOWN) -> PartName:
    facts = {ARM: NodeFacts(), BASE: NodeFacts(parameters=dict(known))}
    return check_request(MODEL, facts, request)


@pytest.mark.parametrize(
    ("request_", "part"),
    [
        (ModeRequest(ACTUATION, "PERFORMANCE"), ACTUATION),
        (ModeRequest(BASE, "FAST"), BASE),
        (TransitionRequest(ACTUATION, Transition.CONFIGURE), ACTUATION),
        (TransitionRequest(BASE, Transition.SHUTDOWN), BASE),
        (ParametersRequest(BASE, {"max_speed": 0.4}), BASE),
    ],
    ids=str,
)
def test_a_request_is_about_its_part(request_: ChangeRequest, part: PartName) -> None:
    assert _check(request_) == part


@pytest.mark.parametrize(
    "request_",
    [
        ModeRequest(PartName("gripper"), "FAST"),
        TransitionRequest(PartName("gripper"), Transition.CONFIGURE),
        ParametersRequest(PartName("gripper"), {"a": 1}),
    ],
    ids=str,
)
def test_an_unknown_part_is_told(request_: ChangeRequest) -> None:
    with pytest.raises(UnknownPartError, match="gripper"):
        _check(request_)


def test_a_system_has_no_parameters() -> None:
    with pytest.raises(UnknownPartError, match="'actuation' is a system, not a node"):
        _check(ParametersRequest(ACTUATION, {"max_speed": 0.4}))


@pytest.mark.parametrize(
    ("part", "mode"),
    [(ACTUATION, "FAST"), (BASE, "PERFORMANCE"), (BASE, "fast"), (BASE, "")],
)
def test_a_mode_of_another_part_is_unknown(part: PartName, mode: str) -> None:
    with pytest.raises(UnknownModeError):
        _check(ModeRequest(part, mode))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, (0.0, math.nan)], ids=str)
def test_a_number_that_is_not_finite_is_refused_even_of_an_unknown_node(
    value: ParameterValue,
) -> None:
    with pytest.raises(InvalidValueError, match="finite") as refusal:
        _check(ParametersRequest(BASE, {"max_speed": value}), known={})
    assert refusal.value.pointer == "max_speed"


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("max_speed", 1),
        ("max_speed", True),
        ("max_speed", "0.5"),
        ("controller", 1.0),
        ("retries", 3.0),
        ("retries", True),
        ("brake", 1),
        ("gains", 1.0),
        ("gains", (1, 2)),
        ("gains", ("a",)),
        ("max_speed", (0.5,)),
    ],
    ids=str,
)
def test_a_value_of_another_type_is_refused_as_ros_2_would(
    name: str, value: ParameterValue
) -> None:
    with pytest.raises(InvalidValueError) as refusal:
        _check(ParametersRequest(BASE, {name: value}))
    assert refusal.value.pointer == name


@pytest.mark.parametrize(
    ("known", "value", "message"),
    [
        (0.5, 1, "p of drive_base is of type double, not 1"),
        ((0.5,), (1,), "p of drive_base is of type double_array, not (1,)"),
        ((), 1, "p of drive_base is of type array, not 1"),
    ],
    ids=str,
)
def test_the_type_that_is_wanted_is_told(
    known: ParameterValue, value: ParameterValue, message: str
) -> None:
    with pytest.raises(InvalidValueError) as refusal:
        _check(ParametersRequest(BASE, {"p": value}), known={"p": known})
    assert refusal.value.message == message


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("max_speed", 0.9),
        ("controller", ""),
        ("retries", -1),
        ("brake", True),
        ("gains", (3.0,)),
        ("gains", ()),
    ],
    ids=str,
)
def test_a_value_of_the_same_type_is_taken(name: str, value: ParameterValue) -> None:
    assert _check(ParametersRequest(BASE, {name: value})) == BASE


def test_a_value_is_taken_where_an_empty_array_is_known() -> None:
    assert _check(ParametersRequest(BASE, {"gains": (1,)}), known={"gains": ()}) == BASE


def test_a_parameter_that_the_node_does_not_have_is_told_with_those_that_it_has() -> None:
    with pytest.raises(UnknownParameterError) as refusal:
        _check(ParametersRequest(BASE, {"speed": 0.4}), known={"max_speed": 0.5})
    assert refusal.value.hint == "known: max_speed"


def test_of_a_node_that_told_no_parameters_any_may_be_right() -> None:
    assert _check(ParametersRequest(BASE, {"speed": 0.4}), known={}) == BASE


def test_one_bad_value_among_good_ones_refuses_all() -> None:
    with pytest.raises(InvalidValueError):
        _check(ParametersRequest(BASE, {"max_speed": 0.4, "controller": 7}))


def test_a_request_that_sets_nothing_is_refused() -> None:
    with pytest.raises(InvalidValueError, match="no parameter"):
        _check(ParametersRequest(BASE, {}))


@pytest.mark.parametrize(
    ("request_", "shown"),
    [
        (ModeRequest(BASE, "FAST", Actor("alice")), {"mode": "FAST"}),
        (TransitionRequest(BASE, Transition.CLEANUP), {"transition": "cleanup"}),
        (ParametersRequest(BASE, {"max_speed": 0.4}), {"parameters": {"max_speed": 0.4}}),
    ],
    ids=str,
)
def test_a_request_is_shown_as_it_is_written(
    request_: ChangeRequest, shown: dict[str, object]
) -> None:
    assert describe_request(request_) == shown


def test_a_parameter_that_there_is_not_is_told_with_those_that_there_are() -> None:
    with pytest.raises(UnknownParameterError) as unknown:
        _check(ParametersRequest(BASE, {"speed": 1.0}), {"max_speed": 0.5, "retries": 3})
    assert unknown.value.message == "there is no parameter of drive_base 'speed'"
    assert unknown.value.hint == "known: max_speed, retries; did you mean max_speed?"


@pytest.mark.parametrize(
    ("request_", "message", "hint"),
    [
        (
            ModeRequest(PartName("tail"), "FAST"),
            "there is no part 'tail'",
            "known: actuation, drive_base, manipulator",
        ),
        (
            ParametersRequest(PartName("tail"), {"a": 1}),
            "there is no node 'tail'",
            "known: drive_base, manipulator",
        ),
    ],
    ids=["part", "node"],
)
def test_a_part_that_there_is_not_is_told_with_those_that_there_are(
    request_: ChangeRequest, message: str, hint: str
) -> None:
    with pytest.raises(UnknownPartError) as unknown:
        _check(request_)
    assert (unknown.value.message, unknown.value.hint) == (message, hint)


def test_a_request_without_a_parameter_is_refused() -> None:
    with pytest.raises(InvalidValueError) as refused:
        _check(ParametersRequest(BASE, {}))
    assert refused.value.message == "no parameters are given"
