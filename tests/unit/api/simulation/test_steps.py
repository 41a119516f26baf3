import asyncio
from collections.abc import Iterator
from typing import Any

import pytest
from pydantic import TypeAdapter

from api.http.schemas.problem import Problem
from api.http.schemas.simulation import Step as AnyKindOfStep
from api.simulation.steps import Actors
from domain.state_and_mode import PartName
from domain.timebase import seconds
from service.simulation.virtual_time import VirtualService
from tests.support.scenarios import ALL_GOOD, STRAIGHT, Step, scenario, virtual_robot

STEPS: TypeAdapter[Any] = TypeAdapter(AnyKindOfStep)


class Stage:
    """A robot, and whoever does something to it."""

    def __init__(self, runner: asyncio.Runner) -> None:
        self.robot: VirtualService = virtual_robot(scenario())
        self._actors = Actors(self.robot, runner)
        self.pass_time(0.1)

    def act(self, **step: Any) -> Problem | None:  # noqa: ANN401
        return self._actors.act(STEPS.validate_python({"t_s": 0, **step}))

    def pass_time(self, by_s: float) -> None:
        self.robot.advance_to(self.robot.clock.now() + seconds(by_s))

    @property
    def core(self) -> Any:  # noqa: ANN401
        return self.robot.supervisor.core

    def actual(self, part: str) -> str:
        return str(self.core.part(PartName(part)).actual.state_and_mode.label)


@pytest.fixture
def stage() -> Iterator[Stage]:
    with asyncio.Runner() as runner:
        yield Stage(runner)


def test_a_reading_arrives(stage: Stage) -> None:
    assert stage.act(**ALL_GOOD) is None
    assert stage.act(reading={"battery_level": 0.25}) is None

    assert stage.core.system_state().errors == ("BATTERY_LOW",)


def test_a_reading_has_no_stamp_unless_it_says_how_old_it_is(stage: Stage) -> None:
    stage.act(reading={"temperature": 30})
    assert stage.act(reading={"temperature": 31}, stamp_offset_s=-5) is None

    # Older than the one with a stamp, and no worse.
    refused = stage.act(reading={"temperature": 30}, stamp_offset_s=-6)
    assert refused is not None
    assert refused.code == "OUTDATED_READING"


def test_two_sources_of_the_estop_do_not_release_each_other(stage: Stage) -> None:
    stage.act(reading={"estop": True}, source="left button")
    stage.act(reading={"estop": False}, source="right button")
    stage.pass_time(1)

    assert "ESTOP" in stage.core.system_state().errors


def test_a_task_is_served_and_canceled(stage: Stage) -> None:
    stage.act(**ALL_GOOD)

    assert stage.act(task={"waypoints": STRAIGHT, "controller": "stanley"}) is None
    assert stage.core.driving.current_task.controller == "stanley"
    assert stage.act(task=None) is None
    assert stage.core.driving.current_task is None


def test_a_mode_is_asked_for_and_arrives(stage: Stage) -> None:
    assert stage.act(change={"part": "drive_base", "mode": "FAST"}) is None
    stage.pass_time(3)

    assert stage.actual("drive_base") == "active.FAST"


def test_a_transition_is_asked_for_and_arrives(stage: Stage) -> None:
    assert stage.act(change={"part": "actuation", "transition": "configure"}) is None
    stage.pass_time(3)

    assert stage.actual("actuation") == "inactive"


def test_a_node_falls_silent_and_is_heard_again(stage: Stage) -> None:
    stage.act(node="drive_base", fault="die")
    stage.pass_time(5)
    assert not stage.core.part(PartName("drive_base")).reachable

    stage.act(node="drive_base", fault="recover")
    stage.pass_time(5)
    assert stage.core.part(PartName("drive_base")).reachable


def test_somebody_else_sets_the_parameters_of_a_node(stage: Stage) -> None:
    stage.act(change={"part": "drive_base", "mode": "FAST"})
    stage.pass_time(3)

    assert stage.act(node="drive_base", parameters={"max_speed": 0.2, "controller": "PID"}) is None
    stage.pass_time(1)

    assert stage.actual("drive_base") == "active.SLOW"


def test_the_vehicle_falls_silent_and_is_heard_again(stage: Stage) -> None:
    stage.act(vehicle="silent")
    stage.pass_time(1)
    assert "vehicle" in stage.core.driving.holds

    stage.act(vehicle="recover")
    stage.pass_time(1)
    assert "vehicle" not in stage.core.driving.holds


def test_a_request_reaches_the_interface(stage: Stage) -> None:
    assert (
        stage.act(request={"method": "PUT", "path": "/holds/operator", "body": {"reason": "lunch"}})
        is None
    )

    assert stage.core.driving.holds["operator"].reason == "lunch"


@pytest.mark.parametrize(
    ("step", "code"),
    [
        ({"reading": {"batery_level": 0.5}}, "UNKNOWN_SIGNAL"),
        ({"reading": {"battery_level": 1.5}}, "INVALID_VALUE"),
        ({"task": {"waypoints": STRAIGHT[:1]}}, None),
        ({"task": {"waypoints": [{**STRAIGHT[0], "x_m": 9}, {**STRAIGHT[0], "x_m": 12}]}}, None),
        ({"task": {"waypoints": STRAIGHT, "controller": "magic"}}, "UNKNOWN_CONTROLLER"),
        ({"change": {"part": "wing", "mode": "FAST"}}, "UNKNOWN_PART"),
        ({"change": {"part": "drive_base", "mode": "WARP"}}, "UNKNOWN_MODE"),
        ({"change": {"part": "drive_base", "transition": "deactivate"}}, None),
        ({"node": "wing", "fault": "silent"}, "UNKNOWN_PART"),
        ({"node": "actuation", "parameters": {"a": 1}}, "UNKNOWN_PART"),
        ({"request": {"method": "GET", "path": "/nowhere"}}, "UNKNOWN_PATH"),
    ],
)
def test_what_is_refused_says_why_and_changes_nothing(
    step: Step, code: str | None, stage: Stage
) -> None:
    before = (stage.core.system_state(), stage.core.driving.current_task, stage.core.parts())

    refused = stage.act(**step)

    assert refused is not None
    assert refused.detail
    assert code is None or refused.code == code
    assert (
        stage.core.system_state(),
        stage.core.driving.current_task,
        stage.core.parts(),
    ) == before
