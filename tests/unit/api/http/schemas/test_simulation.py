from typing import Any

import pytest
from pydantic import ValidationError

from api.http.schemas.simulation import (
    MAX_DEPTH,
    ChangeStep,
    ConditionStep,
    ExpectStep,
    NodeStep,
    ReadingStep,
    RequestStep,
    SimulationBody,
    TaskStep,
    VehicleStep,
    place_in_body,
)

READING = {"reading": {"battery_level": 0.5}}


def body(*steps: dict[str, Any], **more: Any) -> SimulationBody:  # noqa: ANN401
    timed = [{"t_s": 0, **step} for step in steps]
    return SimulationBody.model_validate({"until_s": 10, "steps": timed, **more})


def nested(depth: int) -> dict[str, Any]:
    value: dict[str, Any] = {"a": 1}
    for _ in range(depth - 1):
        value = {"a": value}
    return value


def test_what_is_left_out_is_usual() -> None:
    usual = SimulationBody(until_s=3)

    assert (usual.model, usual.robot, usual.begin, usual.title) == (None, None, None, "")
    assert (usual.sample_period_s, usual.steps) == (1.0, [])


@pytest.mark.parametrize(
    ("step", "kind"),
    [
        (READING, ReadingStep),
        ({"task": None}, TaskStep),
        ({"change": {"part": "arm", "mode": "STRONG"}}, ChangeStep),
        ({"change": {"part": "arm", "transition": "activate"}}, ChangeStep),
        ({"node": "arm", "fault": "silent"}, NodeStep),
        ({"node": "arm", "parameters": {"max_torque": 0.1}}, NodeStep),
        ({"vehicle": "silent"}, VehicleStep),
        ({"vehicle": "weak_brakes"}, VehicleStep),
        ({"request": {"method": "GET", "path": "/tasks"}}, RequestStep),
        ({"expect": {"task": None}}, ExpectStep),
        ({"expect": "battery_level >= 0.3"}, ConditionStep),
    ],
)
def test_a_step_is_told_by_what_it_names(step: dict[str, Any], kind: type) -> None:
    (read,) = body(step).steps

    assert type(read) is kind


@pytest.mark.parametrize(
    ("step", "words"),
    [
        ({}, "one of reading, task, change, node, vehicle, request, expect"),
        ({"what": 1}, "one of reading, task, change"),
        ({"reading": {}}, "at least 1"),
        ({"reading": {"battery_level": None}}, "a signal value must be"),
        ({**READING, "repeat_hz": 0}, "greater than 0"),
        ({**READING, "repeat_hz": 1_001}, "less than or equal to 1000"),
        ({**READING, "repeat_hz": 10, "refused": True}, "cannot be repeated"),
        ({**READING, "task": None}, "Extra inputs"),
        ({"change": {"part": "arm"}}, "either a mode or a transition"),
        ({"change": {"part": "arm", "mode": "A", "transition": "activate"}}, "either"),
        ({"change": {"part": "arm", "transition": "fly"}}, "'configure'"),
        ({"node": "arm"}, "either a fault or parameters"),
        ({"node": "arm", "fault": "sulk"}, "'silent'"),
        ({"vehicle": True}, "'silent'"),
        ({"request": {"method": "TRACE", "path": "/"}}, "'GET'"),
        ({"request": {"method": "GET", "path": "tasks"}}, "pattern"),
        ({"request": {"method": "PUT", "path": "/", "body": nested(40)}}, "levels of nested"),
        ({"expect": {}}, "at least 1"),
        ({"expect": {"events": 3}}, "for each kind of event"),
        ({"expect": {"events": {"task.start": 0}}}, "did you mean task.started?"),
        ({"expect": nested(40)}, "levels of nested"),
        ({"expect": {"task": None}, "refused": True}, "Extra inputs"),
        ({"task": None, "t_s": -1}, "greater than or equal to 0"),
        ({"task": None, "t_s": float("nan")}, "finite"),
        ({"task": None, "t_s": 86_401}, "86400"),
        ({"task": None, "refused": "yes"}, "boolean"),
    ],
)
def test_a_step_that_cannot_be_is_refused(step: dict[str, Any], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        body(step)


def test_as_deep_as_is_allowed_is_taken() -> None:
    assert body({"expect": nested(MAX_DEPTH)}).steps


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"until_s": 86_401}, "86400"),
        ({"until_s": None}, "valid number"),
        ({"sample_period_s": 0}, "greater than 0"),
        ({"until_s": 20_000, "sample_period_s": 1}, "20001 samples; at most 20000"),
        ({"until_s": 20_000, "sample_period_s": 5e-324}, "samples; at most 20000"),
        ({"begin": "live", "model": "a: {}"}, "its own model"),
        ({"from": "live", "robot": {}}, "its own model and settings"),
        ({"from": "dead"}, "'live'"),
        ({"steps": [{"t_s": 0, "task": None}] * 10_001}, "at most 10000"),
        ({"wings": 2}, "Extra inputs"),
    ],
)
def test_a_scenario_beyond_the_limits_is_refused(more: dict[str, Any], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        body(**more)


def test_as_much_as_is_allowed_is_taken() -> None:
    assert body(until_s=86_400, sample_period_s=4.33).until_s == 86_400
    assert body(until_s=19_999, sample_period_s=1.0).until_s == 19_999


def test_readings_are_counted_with_all_their_repetitions() -> None:
    repeated = {"reading": {"a": 1, "b": 2}, "repeat_hz": 1_000}

    assert body(repeated, until_s=2_000, sample_period_s=10).steps
    with pytest.raises(ValidationError, match="5000002 readings; at most 5000000"):
        body(repeated, until_s=2_500, sample_period_s=10)


@pytest.mark.parametrize(
    ("step", "count"),
    [
        ({}, 1),
        ({"repeat_hz": 10}, 101),
        ({"repeat_hz": 10, "until_s": 2}, 21),
        ({"repeat_hz": 10, "until_s": 20}, 101),
        ({"repeat_hz": 3, "until_s": 1}, 4),
        ({"repeat_hz": 0.3, "until_s": 10}, 4),
        ({"t_s": 9.95, "repeat_hz": 10}, 1),
        ({"t_s": 5, "repeat_hz": 10, "until_s": 4}, 1),
        ({"t_s": 0.1, "repeat_hz": 10, "until_s": 0.3}, 3),
    ],
)
def test_repetitions_go_up_to_and_with_their_end(step: dict[str, Any], count: int) -> None:
    assert ReadingStep.model_validate({"t_s": 0, **READING, **step}).count(10) == count


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("battery_level >=", "column 17: expected a name or a value, found the end"),
        ("", "at least 1 character"),
        ("x" * 501, "at most 500 characters"),
    ],
)
def test_a_condition_that_cannot_be_read_is_invalid(text: str, told: str) -> None:
    with pytest.raises(ValidationError, match=told):
        body({"expect": text})


@pytest.mark.parametrize(
    ("location", "keys"),
    [
        (("until_s",), ("until_s",)),
        (("steps", 3), ("steps", 3)),
        (("steps", 3, "node"), ("steps", 3)),
        (("steps", 3, "reading", "reading", "estop"), ("steps", 3, "reading", "estop")),
        (("robot", "nodes", "arm"), ("robot", "nodes", "arm")),
    ],
)
def test_a_fault_of_a_step_is_placed_without_the_kind_of_the_step(
    location: tuple[int | str, ...], keys: tuple[int | str, ...]
) -> None:
    assert place_in_body(location) == keys
