from random import Random

import pytest

from api.profiling.profile import Progress, measure_runs
from api.profiling.robot import LostServiceError
from api.profiling.run_file import Run
from api.profiling.triggers import TRIGGERS
from tests.support.profiled_robot import ProfiledRobot

ESTOP, GPS = TRIGGERS["ESTOP"], TRIGGERS["GPS_LOST"]


async def test_triggers_take_turns() -> None:
    runs: list[Run] = []

    await measure_runs(ProfiledRobot(), [ESTOP, GPS], 3, Random(1), runs.append, lambda _: None)

    assert [(run.number, run.trigger) for run in runs] == [
        (1, "ESTOP"),
        (1, "GPS_LOST"),
        (2, "ESTOP"),
        (2, "GPS_LOST"),
        (3, "ESTOP"),
        (3, "GPS_LOST"),
    ]
    assert all(run.is_ok for run in runs)


async def test_the_time_that_is_left_is_told_before_each_run() -> None:
    told: list[tuple[float, Progress]] = []
    robot = ProfiledRobot()

    def tell(progress: Progress) -> None:
        told.append((robot.now(), progress))

    await measure_runs(robot, [ESTOP, GPS], 4, Random(1), lambda _: None, tell)

    assert [(p.done, p.total, p.trigger) for _, p in told[:2]] == [
        (0, 8, "ESTOP"),
        (1, 8, "GPS_LOST"),
    ]
    for at, progress in told:
        assert progress.left_s == pytest.approx(robot.now() - at, abs=10)


async def test_a_failed_run_does_not_end_the_profile() -> None:
    runs: list[Run] = []
    robot = ProfiledRobot(deaf_to=frozenset({"ESTOP"}))

    await measure_runs(robot, [ESTOP, GPS], 2, Random(1), runs.append, lambda _: None)

    assert [run.is_ok for run in runs] == [False, True, False, True]


async def test_what_was_measured_before_the_service_ended_is_kept() -> None:
    runs: list[Run] = []
    robot = ProfiledRobot(ends_after=2)

    with pytest.raises(LostServiceError):
        await measure_runs(robot, [ESTOP], 5, Random(1), runs.append, lambda _: None)

    assert [run.number for run in runs] == [1, 2]
