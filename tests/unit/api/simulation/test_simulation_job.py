import json
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

import pytest

from api.http.body_parsing import InvalidBodyError, MalformedBodyError
from api.simulation.simulation_job import HAS_DEVICES, LiveCopy, copy_of, robot_for, simulate_posted
from domain.actor import Actor
from domain.errors import InvalidModelError
from domain.inputs import HoldRequest
from domain.state_and_mode import PartName
from domain.timebase import seconds
from service.simulation.virtual_time import VirtualService
from tests.support.http_robot import ACTUATION
from tests.support.scenarios import ALL_GOOD, STRAIGHT, scenario, virtual_robot

WRONG = "arm: {ros__parameters: {type: system, modes: {__DEFAULT__: {arm: active}}}}"
NOW = datetime(2026, 5, 1, 12, tzinfo=UTC)


def posted(body: Mapping[str, Any], live: LiveCopy | None = None) -> Any:  # noqa: ANN401
    return json.loads(simulate_posted(json.dumps(body).encode(), ACTUATION, live))


def test_a_guard_on_a_signal_that_the_robot_does_not_have_is_rejected() -> None:
    guard = "    mode_settings: {MODERATE: {requires: reach > 3}}\n    modes:\n"
    model = ACTUATION.replace("    modes:\n", guard, 1)

    with pytest.raises(InvalidModelError):
        virtual_robot(scenario(model=model, robot={"mock": True}))
    robot = virtual_robot(scenario(model=model, robot={"signals": {"reach": {"minimum": 0}}}))
    assert robot.supervisor.warnings == ()


@pytest.fixture
def live() -> VirtualService:
    """A robot that is in the middle of something."""
    robot = virtual_robot(scenario())
    robot.advance_to(seconds(0.1))
    robot.supervisor.submit(HoldRequest("operator", "lunch", Actor("test")))
    robot.advance_to(seconds(2))
    return robot


def copied(robot: VirtualService) -> LiveCopy:
    state = copy_of(robot.onboard, robot.robot)
    return LiveCopy(state, robot.clock.now(), NOW, robot.supervisor.events.newest)


def test_a_scenario_happens_to_the_loaded_model() -> None:
    told = posted({"until_s": 1})

    assert set(told) == {"samples", "events", "refusals", "expectations"}
    assert set(told["samples"][0]["parts"]) == {"actuation", "drive_base", "manipulator"}


def test_another_model_is_taken_where_one_is_sent() -> None:
    model = "arm: {ros__parameters: {type: node}}"

    assert set(posted({"until_s": 1, "model": model})["samples"][0]["parts"]) == {"arm"}
    assert set(posted({"until_s": 1, "model": None})["samples"][0]["parts"]) != {"arm"}


def test_readings_come_from_the_scenario_alone_unless_mocks_are_asked_for() -> None:
    assert posted({"until_s": 5})["samples"][-1]["system_state"]["errors"] == ["STALE_DATA"]

    mocked = posted({"until_s": 5, "robot": {"mock": True}})
    assert mocked["samples"][-1]["system_state"]["errors"] == []
    assert "signals" in mocked["samples"][-1]["system_state"]["simulated"]


def test_settings_are_those_of_a_robot_file() -> None:
    robot = {"vehicle": {"pose": {"x_m": 3.0, "y_m": -1.0, "yaw_rad": 0.5}}}

    pose = posted({"until_s": 1, "robot": robot})["samples"][-1]["vehicle"]["pose"]

    assert pose == {"x_m": 3.0, "y_m": -1.0, "yaw_rad": 0.5}


@pytest.mark.parametrize(
    ("robot", "pointer"),
    [
        ({"wings": 2}, "/robot/wings"),
        ({"signals": {"battery_level": {"threshold": "x"}}}, "/robot/signals"),
        ({"nodes": {"wing": {}}}, "/robot/nodes/wing"),
        ({"start_task": {"file": "track.csv"}}, "/robot/start_task"),
    ],
)
def test_wrong_settings_are_told_with_their_place(robot: dict[str, Any], pointer: str) -> None:
    with pytest.raises(InvalidBodyError) as refused:
        posted({"until_s": 1, "robot": robot})

    assert refused.value.faults[0].pointer.startswith(pointer)


def test_a_condition_that_names_what_the_robot_does_not_have_is_told_before_it_runs() -> None:
    steps = [
        {"t_s": 0, "expect": "speed < 1 and drive_base.mode == FASTER"},
        {"t_s": 0, "expect": "battery_level >= 30"},
    ]
    declared = {"signals": {"speed": {"unit": "m/s"}}}

    with pytest.raises(InvalidBodyError) as caught:
        posted({"until_s": 1, "robot": declared, "steps": steps})

    (fault,) = caught.value.faults
    assert (fault.pointer, fault.code) == ("/steps/0/expect", "UNKNOWN_MODE")
    assert fault.message.startswith("column 34: drive_base.mode is never 'FASTER'")


def test_a_condition_that_cannot_be_read_is_told_with_its_column() -> None:
    with pytest.raises(InvalidBodyError) as caught:
        posted({"until_s": 1, "steps": [{"t_s": 0, "expect": "estop and {x}"}]})

    (fault,) = caught.value.faults
    assert (fault.pointer, fault.code) == ("/steps/0/expect", "CONDITION_SYNTAX")
    assert fault.message == "column 11: '{' is not allowed here"


def test_a_wrong_model_is_told_with_its_findings() -> None:
    with pytest.raises(InvalidModelError):
        posted({"until_s": 1, "model": WRONG})


@pytest.mark.parametrize("raw", [b"", b"{", b"\xff"])
def test_what_is_no_json_is_malformed(raw: bytes) -> None:
    with pytest.raises(MalformedBodyError):
        simulate_posted(raw, ACTUATION, None)


def test_a_copy_that_cannot_be_had_is_refused() -> None:
    body = scenario(begin="live")

    with pytest.raises(InvalidBodyError, match="only a simulated one can be copied"):
        robot_for(body, ACTUATION, None)


def test_why_a_robot_of_several_computers_cannot_be_copied_is_told() -> None:
    with pytest.raises(InvalidBodyError, match="has several computers"):
        robot_for(scenario(begin="live"), ACTUATION, None, HAS_DEVICES)


def test_a_robot_of_several_computers_is_simulated_as_on_one() -> None:
    body = scenario(robot={"devices": {"arm": {"parts": ["manipulator"]}}})

    robot = robot_for(body, ACTUATION, None)
    robot.advance_to(seconds(5))

    assert robot.onboard.core.devices() == {}
    part = robot.onboard.core.part(PartName("manipulator"))
    assert (part.device, part.reachable) == (None, True)


def test_a_copy_goes_on_from_the_live_robot_in_time_events_and_state(live: VirtualService) -> None:
    copy = copied(live)

    told = posted(
        {
            "from": "live",
            "until_s": 4,
            "steps": [
                ALL_GOOD,
                {"t_s": 1, "task": {"waypoints": STRAIGHT}},
                {"t_s": 2, "request": {"method": "DELETE", "path": "/holds/operator"}},
            ],
        },
        copy,
    )

    assert told["samples"][0]["system_state"]["at"] == "2026-05-01T12:00:00.000Z"
    assert told["samples"][0]["parts"]["drive_base"]["actual"]["state"] == "unconfigured"
    assert [sample["task"] and sample["task"]["status"] for sample in told["samples"]] == [
        None,
        "PAUSED",
        "RUNNING",
        "RUNNING",
        "RUNNING",
    ]
    assert told["events"][0]["id"] == copy.events + 1


def test_what_happens_to_a_copy_does_not_happen_to_the_live_robot(live: VirtualService) -> None:
    before = copy_of(live.onboard, live.robot)
    steps = [
        ALL_GOOD,
        {"t_s": 1, "task": {"waypoints": STRAIGHT}},
        {"t_s": 1, "change": {"part": "actuation", "mode": "PERFORMANCE"}},
        {"t_s": 2, "node": "drive_base", "fault": "die"},
    ]

    posted({"from": "live", "until_s": 10, "steps": steps}, copied(live))

    assert copy_of(live.onboard, live.robot) == before
    assert live.supervisor.core.driving.holds.keys() == {"operator"}


def test_a_copy_is_the_same_however_often_it_is_used(live: VirtualService) -> None:
    copy = copied(live)
    body = {"from": "live", "until_s": 5, "steps": [ALL_GOOD]}

    assert posted(body, copy) == posted(body, copy)
