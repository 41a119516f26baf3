from typing import Any

import pytest

from api.http.schemas.simulation import SimulationJson
from api.simulation import simulation as module
from api.simulation.simulation import Simulation
from tests.support.scenarios import (
    ALL_GOOD,
    NEVER_STALE,
    STRAIGHT,
    Step,
    answer,
    happened,
    scenario,
    virtual_robot,
)


def expect(t_s: float, **expected: Any) -> Step:  # noqa: ANN401
    return {"t_s": t_s, "expect": expected}


def sampled(**more: Any) -> list[float]:  # noqa: ANN401
    return [sample["t_s"] for sample in answer(happened(**more))["samples"]]


def times_of(told: dict[str, Any], kind: str) -> list[str]:
    return [event["at"] for event in told["events"] if event["kind"] == kind]


# --- time ----------------------------------------------------------------------------------------


def test_samples_are_taken_on_a_grid_with_both_ends() -> None:
    assert sampled(until_s=2, sample_period_s=0.5) == [0, 0.5, 1, 1.5, 2]


def test_an_end_that_is_not_on_the_grid_has_no_sample() -> None:
    assert sampled(until_s=2, sample_period_s=0.7) == [0, 0.7, 1.4]


def test_a_scenario_without_length_has_one_sample_and_its_steps_happen() -> None:
    told = answer(happened({"t_s": 0, "reading": {"estop": True}}, until_s=0))

    assert [sample["t_s"] for sample in told["samples"]] == [0]
    assert times_of(told, "error.raised") == ["2000-01-01T00:00:00.000Z"]


def test_the_sample_at_the_begin_comes_before_the_first_step() -> None:
    told = answer(happened({"t_s": 0, "reading": {"estop": True}}, until_s=1))

    assert [sample["system_state"]["errors"] for sample in told["samples"]] == [[], ["ESTOP"]]


def test_a_sample_comes_after_everything_due_and_all_steps_at_its_time() -> None:
    told = answer(
        happened(
            {"t_s": 0, "reading": {"gps_accuracy": 100}},
            {"t_s": 0, "reading": {"gps_accuracy": 300}},
            {"t_s": 15, "reading": {"temperature": 60}},
            until_s=15,
            sample_period_s=5,
        )
    )

    assert told["samples"][-2]["system_state"]["errors"] == []
    assert told["samples"][-1]["system_state"]["errors"] == ["GPS_LOST", "TEMPERATURE_HIGH"]


def test_what_is_due_at_a_time_comes_before_the_steps_at_it() -> None:
    told = answer(
        happened(
            {"t_s": 0, "reading": {"gps_accuracy": 300}},
            {"t_s": 15, "reading": {"gps_accuracy": 100}},
            until_s=20,
        )
    )

    assert times_of(told, "error.raised") == ["2000-01-01T00:00:15.000Z"]


def test_steps_at_the_same_time_happen_in_their_order() -> None:
    simulation = happened(
        {"t_s": 2, "reading": {"battery_level": 0.9}},
        expect(1, system_state={"errors": ["BATTERY_LOW"]}),
        {"t_s": 0, "reading": {"battery_level": 0.1}},
        expect(2, system_state={"errors": []}),
        {"t_s": 2, "reading": {"battery_level": 0.2}},
        expect(2, system_state={"errors": ["BATTERY_LOW"]}),
    )

    assert [item.step for item in simulation.expectations] == [1, 3, 5]
    assert simulation.failed_expectations() == []


def test_a_repeated_reading_arrives_on_a_grid_up_to_and_with_its_end() -> None:
    repeated = {"t_s": 0, "reading": {"temperature": 30}, "repeat_hz": 10, "until_s": 1}
    silent = {"signals": {"stale_after_s": 0, "temperature": {"stale_after_s": 0.1}}}

    told = answer(happened(repeated, until_s=3, robot=silent))

    # Strictly older than 0.1 s is stale: after the last one, at exactly 1 s.
    (raised,) = (event for event in told["events"] if event["kind"] == "error.raised")
    assert raised["at"].startswith("2000-01-01T00:00:01.1")


def test_repetitions_are_between_the_other_steps() -> None:
    simulation = happened(
        {"t_s": 0, "reading": {"battery_level": 0.9}, "repeat_hz": 2, "until_s": 2},
        {"t_s": 0.75, "reading": {"battery_level": 0.1}},
        expect(0.8, system_state={"errors": ["BATTERY_LOW"]}),
        expect(1, system_state={"errors": []}),
    )

    assert simulation.failed_expectations() == []


def test_what_would_happen_after_the_end_does_not() -> None:
    told = answer(happened({"t_s": 5, "reading": {"estop": True}}, until_s=4))

    assert times_of(told, "error.raised") == []


def test_progress_is_told_up_to_the_end_also_where_nothing_happens() -> None:
    body = scenario(until_s=100, sample_period_s=100)
    told: list[float] = []

    Simulation(body, virtual_robot(body)).run(told.append)

    assert told == sorted(told)
    assert len(set(told)) > 5
    assert told[-1] == 100


# --- what comes of it ----------------------------------------------------------------------------


def test_the_same_scenario_twice_is_the_same_to_the_byte() -> None:
    steps = [
        ALL_GOOD,
        {"t_s": 1, "task": {"waypoints": STRAIGHT}},
        {"t_s": 2, "change": {"part": "actuation", "mode": "PERFORMANCE"}},
        {"t_s": 3, "request": {"method": "PUT", "path": "/holds/operator", "body": {}}},
        {"t_s": 4, "node": "drive_base", "fault": "die"},
        {"t_s": 5, "change": {"part": "wing", "mode": "FAST"}},
    ]
    noise = {"position_m": 0.02, "yaw_rad": 0.01, "seed": 7}
    robot = {**NEVER_STALE, "vehicle": {"plant": {"noise": noise}}}

    texts = {happened(*steps, robot=robot).as_json() for _ in range(2)}

    assert len(texts) == 1


def test_the_answer_is_what_the_schema_says() -> None:
    simulation = happened(
        ALL_GOOD, {"t_s": 1, "change": {"part": "wing", "mode": "FAST"}}, expect(2, task=3)
    )

    told = SimulationJson.model_validate_json(simulation.as_json())

    assert (told.refusals[0].step, told.refusals[0].problem.code) == (1, "UNKNOWN_PART")
    assert (told.expectations[0].step, told.expectations[0].t_s) == (2, 2)
    assert told.expectations[0].differences[0].path == "task"


def test_events_tell_when_they_were() -> None:
    simulation = happened({"t_s": 2.5, "reading": {"estop": True}})

    (raised,) = (event for event in simulation.events if event.kind == "error.raised")
    assert simulation.seconds_to(raised) == 2.5


# --- expectations and refusals -------------------------------------------------------------------


def test_an_expectation_may_name_the_task_that_has_ended_and_count_events() -> None:
    simulation = happened(
        ALL_GOOD,
        {"t_s": 1, "task": {"waypoints": STRAIGHT}},
        {"t_s": 3, "task": None},
        expect(
            3,
            task=None,
            last_task={"status": "CANCELED"},
            events={"task.canceled": 1, "task.aborted": 0, "task.started": {"at_least": 1}},
        ),
    )

    assert simulation.failed_expectations() == []


def test_what_is_seen_otherwise_is_told() -> None:
    simulation = happened(expect(1, last_task={"status": "RUNNING"}, events={"hold.set": 4}))

    (failed,) = simulation.failed_expectations()
    assert [(item.path, item.expected, item.seen) for item in failed.differences] == [
        ("last_task", {"status": "RUNNING"}, None),
        ("events.hold.set", 4, 0),
    ]


def test_a_refused_step_is_told_and_the_others_happen() -> None:
    simulation = happened(
        {"t_s": 1, "reading": {"battery_level": 7}}, {"t_s": 2, "reading": {"estop": True}}
    )

    (refused,) = simulation.unexpected_refusals()
    assert (refused.step, refused.t_s, refused.problem.code) == (0, 1, "INVALID_VALUE")
    assert [event.kind for event in simulation.events].count("error.raised") == 1


def test_a_step_that_is_expected_to_be_refused_is_as_expected_when_it_is() -> None:
    simulation = happened({"t_s": 1, "reading": {"battery_level": 7}, "refused": True})

    assert [item.step for item in simulation.refusals] == [0]
    assert simulation.unexpected_refusals() == []
    assert [item.step for item in simulation.expectations] == [0]
    assert simulation.failed_expectations() == []


def test_a_step_that_should_have_been_refused_and_was_not_is_a_difference() -> None:
    simulation = happened({"t_s": 1, "reading": {"battery_level": 0.7}, "refused": True})

    (failed,) = simulation.failed_expectations()
    (found,) = failed.differences
    assert (found.path, found.expected, found.seen) == ("refused", True, False)


def test_refusals_without_end_are_told_up_to_a_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_REFUSALS", 3)
    wrong = {"t_s": 0, "reading": {"battery_level": 7}, "repeat_hz": 10}
    expected = {"t_s": 5, "reading": {"battery_level": 7}, "refused": True}

    simulation = happened(wrong, expected)

    assert len(simulation.unexpected_refusals()) == 3
    assert [item.step for item in simulation.refusals] == [0, 0, 0, 1]


# --- conditions ----------------------------------------------------------------------------------


def test_a_condition_is_expected_at_its_time() -> None:
    simulation = happened(
        ALL_GOOD,
        {"t_s": 1, "expect": "battery_level == 1 and not error.BATTERY_LOW"},
        {"t_s": 2, "reading": {"battery_level": 0.4}},
        {"t_s": 2, "expect": "error.BATTERY_LOW and robot.state == ERROR and hold.error"},
    )

    assert [item.step for item in simulation.expectations] == [1, 3]
    assert simulation.failed_expectations() == []


def test_a_condition_that_is_not_true_comes_with_the_tree_of_its_reasons() -> None:
    told = answer(
        happened(
            ALL_GOOD,
            {"t_s": 1, "reading": {"battery_level": 0.4}},
            {"t_s": 2, "expect": "battery_level < 0.5 and not error.BATTERY_LOW"},
            {"t_s": 2, "expect": "vehicle.speed_mps > 1 or actuation.state == active"},
        )
    )

    failed, other = told["expectations"]
    assert failed["differences"] == [
        {
            "path": "",
            "expected": "battery_level < 0.5 and not error.BATTERY_LOW",
            "seen": "false",
        }
    ]
    (root,) = failed["blockers"]
    (leaf,) = root["causes"]
    assert (leaf["condition"], leaf["message"]) == (
        "not error.BATTERY_LOW",
        "BATTERY_LOW is active",
    )
    assert leaf["since_at"] == "2000-01-01T00:00:01.000Z"
    assert [cause["code"] for cause in leaf["causes"]] == ["BATTERY_LOW"]
    assert len(other["blockers"][0]["causes"]) == 2


def test_what_is_not_known_is_not_as_expected() -> None:
    (failed,) = happened({"t_s": 1, "expect": "battery_level < 2"}).failed_expectations()

    assert failed.differences[0].seen == "unknown"
    assert failed.blockers[0].message == "battery_level was never seen, needs < 2"
