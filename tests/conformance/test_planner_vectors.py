"""The vectors of smart_polaris on its task planner (group 09), and those that need a task.

Those that script the controller are played on the supervision alone; all others on supervision,
navigation and simulated vehicle, in virtual time.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Any

import pytest

from domain.errors import PilothouseError
from domain.identifiers import TaskId
from domain.parts.system_model import SmhModel
from domain.paths.path import Path
from domain.supervision import SupervisionSettings
from domain.timebase import seconds
from service.files.robot_settings import SignalsBlock
from service.files.waypoint_file import read_waypoints_csv
from tests.support.core_robot import CoreRobot
from tests.support.paths import straight
from tests.support.planner_vectors import PlannerRobot, Seen, play
from tests.support.polaris import Vector
from tests.support.scripted_robot import ScriptedRobot
from tests.support.shared import json_cases, shared_folder

VECTORS = json_cases("conformance/polaris/vectors", "09_*.json", "vectors")
INJECTING = json_cases("conformance/polaris/vectors", "01_*.json", "vectors")

NOT_STALE = SupervisionSettings(SignalsBlock(stale_after_s=0.0).to_domain())


def read_path(file: str) -> Path:
    """Return a fixture; a request has no names of files, so one outside of them is not found.

    Raises:
        PilothouseError: It is no path.
        FileNotFoundError: There is no such fixture.
    """
    folder = shared_folder("conformance/polaris/fixtures")
    found = {path.name: path for path in folder.glob("*.csv")}.get(file)
    if found is None:
        raise FileNotFoundError(file)
    return Path(read_waypoints_csv(FilePath(found).read_bytes().decode()))


class OnTheRobot:
    """Everything that runs live, in virtual time."""

    def __init__(self, vector: Vector) -> None:
        self._virtual = CoreRobot(SmhModel({}, {}), NOT_STALE)
        self._robot: CoreRobot | ScriptedRobot = self._virtual
        self._files: dict[TaskId, str] = {}
        start_task = vector["config"].get("waypoint_file")
        if start_task is not None:
            self.serve(start_task)

    def advance_to(self, at_s: float) -> None:
        self._virtual.advance(at_s - self._virtual.now / seconds(1))

    def reading(self, signal: str, value: object) -> None:
        self._robot.read(**{signal: value})  # type: ignore[arg-type]

    def serve(self, file: str) -> bool:
        try:
            task = self._robot.submit_task(read_path(file)).task
        except (PilothouseError, FileNotFoundError):
            return False
        assert task is not None
        self._files[task] = file
        return True

    def cancel(self) -> None:
        self._robot.cancel_task()

    def controller(self, step: Mapping[str, Any]) -> None:
        raise NotImplementedError(step)

    def observe(self) -> Seen:
        core = self._robot.core
        view, task = core.system_state(), core.driving.current_task
        last = next(iter(core.driving.tasks()), None)
        return Seen(
            state=view.state,
            errors=frozenset(view.errors),
            planner=view.task_status,
            start_index=None if task is None else task.target_index,
            active_goal_start_index=None,
            task_file=None if task is None else self._files[task.id],
            commanded_mps=core.driving.vehicle.command.speed_mps,
            last_progress=None if last is None else last.progress,
        )


class OnTheSupervision(OnTheRobot):
    """The supervision alone: the vector says what navigation does."""

    def __init__(self, vector: Vector) -> None:
        self._driver = ScriptedRobot(settings=NOT_STALE, good=False)
        self._robot = self._driver
        self._files = {}

    def advance_to(self, at_s: float) -> None:
        while self._driver.now < seconds(at_s):
            self._driver.now = min(self._driver.now + seconds(0.05), seconds(at_s))
            self._driver.report()

    def controller(self, step: Mapping[str, Any]) -> None:
        if step["controller"] == "feedback":
            self._driver.feedback(step["target_index"])
        else:
            self._driver.arrive(succeeded=step["controller"] == "succeed")

    def observe(self) -> Seen:
        seen = super().observe()
        runs = seen.planner == "RUNNING_TASK"
        return replace(
            seen,
            active_goal_start_index=self._driver.goals[-1].start_index if runs else None,
        )


def expectation(vector: Vector) -> str:
    """Name the list of expectations that is ours."""
    return "expected_safer" if vector["successor"] == "should_differ" else "expected"


@pytest.mark.parametrize("vector", VECTORS)
def test_the_planner_does_what_the_vector_says(vector: Vector) -> None:
    scripted = "controller_stub" in vector["needs"]
    kind: type[PlannerRobot] = OnTheSupervision if scripted else OnTheRobot

    assert play(vector, kind(vector), expectation(vector)) == []  # type: ignore[call-arg]


class WithAnInjectedTask(OnTheRobot):
    """A task stands for the status that a vector injects; to pause it is the planner's own work."""

    def reading(self, signal: str, value: object) -> None:
        if signal != "task_status":
            super().reading(signal, value)
        elif value == "RUNNING_TASK":
            self._robot.submit_task(straight(100.0))
        elif value == "NO_TASK":
            self._robot.cancel_task()

    def observe(self) -> Seen:
        self._files = {task.id: "" for task in self._robot.core.driving.tasks()}
        return super().observe()


@pytest.mark.parametrize("vector", INJECTING)
def test_the_state_of_the_robot_follows_from_a_real_task(vector: Vector) -> None:
    if "task_status_injection" not in vector["needs"]:
        pytest.skip("no task in it: test_polaris_vectors plays it")

    assert play(vector, WithAnInjectedTask(vector), expectation(vector)) == []


def test_the_player_notices_a_task_that_does_not_run() -> None:
    vector: Vector = {
        "config": {},
        "steps": [{"t": 0.0, "signal": "estop", "value": True}],
        "expected": [{"t": 0.1, "planner": "RUNNING_TASK"}, {"t": 0.1, "state": "ERROR"}],
    }
    failures = play(vector, OnTheRobot(vector), "expected")

    assert [failure.partition(", seen")[0] for failure in failures] == [
        "100 ms: planner: RUNNING_TASK"
    ]
