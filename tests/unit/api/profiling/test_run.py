import itertools
import re
from random import Random

import pytest

from api.profiling.analysis import LATENCIES, latency_ms
from api.profiling.robot import LostServiceError
from api.profiling.run import PATIENCE_S, measure_run
from api.profiling.run_file import TIMES
from api.profiling.triggers import GOOD, TRIGGERS
from tests.support.profiled_robot import ProfiledRobot


@pytest.mark.parametrize("error", TRIGGERS)
async def test_each_trigger_is_late_by_what_the_robot_takes(error: str) -> None:
    run = await measure_run(ProfiledRobot(delay_s=0.003), TRIGGERS[error], 1, Random(1))

    assert run.is_ok, run.reason
    taken = [latency_ms(run, latency) for latency in LATENCIES]
    assert taken == pytest.approx([3.0] * 6, abs=0.01)
    assert run.times["echo_1_s"] == run.times["echo_2_s"] == pytest.approx(0.0015)


async def test_the_times_of_a_run_are_in_order() -> None:
    run = await measure_run(ProfiledRobot(), TRIGGERS["ESTOP"], 1, Random(1))

    in_order = [name for name in TIMES if not name.startswith("echo")]
    assert [run.times[name] for name in in_order] == sorted(run.times[name] for name in in_order)


async def test_gps_counts_from_the_last_good_reading_and_not_from_the_first_bad_one() -> None:
    run = await measure_run(ProfiledRobot(), TRIGGERS["GPS_LOST"], 1, Random(1))

    assert run.times["counts_from_s"] < run.times["first_bad_s"]
    assert run.times["error_s"] - run.times["counts_from_s"] == pytest.approx(15.002, abs=1e-5)


async def test_stale_data_has_no_bad_reading() -> None:
    robot = ProfiledRobot()

    run = await measure_run(robot, TRIGGERS["STALE_DATA"], 1, Random(1))

    assert "first_bad_s" not in run.times
    battery = [at for at, signal, _ in robot.sent if signal == "battery_level"]
    assert max(b - a for a, b in itertools.pairwise(battery)) > 2.0


async def test_all_signals_are_repeated_while_a_timed_error_is_waited_for() -> None:
    robot = ProfiledRobot()

    await measure_run(robot, TRIGGERS["SIGNAL_LOW"], 1, Random(1))

    for name in GOOD:
        times = [at for at, signal, _ in robot.sent if signal == name]
        assert max(b - a for a, b in itertools.pairwise(times)) < 0.3


async def test_readings_meet_the_ticks_of_the_service_at_random() -> None:
    random = Random(1)
    phases = set()
    for number in range(20):
        run = await measure_run(ProfiledRobot(), TRIGGERS["ESTOP"], number, random)
        phases.add(round(run.times["first_bad_s"] % 0.05, 3))

    assert len(phases) > 10


async def test_an_error_that_never_comes_is_a_failure() -> None:
    robot = ProfiledRobot(deaf_to=frozenset({"ESTOP"}))

    run = await measure_run(robot, TRIGGERS["ESTOP"], 1, Random(1))

    assert re.search(
        r"not seen within 2 s after ESTOP was due: error, pause, zero"
        r" \(last seen: RUNNING RUNNING_TASK, commanded 2.8 m/s\)",
        run.reason,
    )
    assert "error_s" not in run.times
    assert robot.now() >= run.times["first_bad_s"] + PATIENCE_S


async def test_an_error_that_comes_before_its_time_is_a_failure() -> None:
    robot = ProfiledRobot(early_s={"GPS_LOST": 0.5})

    run = await measure_run(robot, TRIGGERS["GPS_LOST"], 1, Random(1))

    assert run.reason == "error was seen 0.498 s too early"
    assert latency_ms(run, LATENCIES[0]) is None


async def test_an_error_beside_the_one_that_is_measured_is_a_failure() -> None:
    robot = ProfiledRobot(beside={"ESTOP": "MOTOR_OVERLOAD"})

    run = await measure_run(robot, TRIGGERS["ESTOP"], 1, Random(1))

    assert run.reason == "MOTOR_OVERLOAD was raised"


async def test_a_robot_that_does_not_drive_is_a_failure() -> None:
    run = await measure_run(ProfiledRobot(never_starts=True), TRIGGERS["ESTOP"], 1, Random(1))

    assert run.reason.startswith("it did not drive within 10 s (last seen: RUNNING RUNNING_TASK,")
    assert not run.times


async def test_a_service_that_is_gone_is_no_failed_run() -> None:
    with pytest.raises(LostServiceError):
        await measure_run(ProfiledRobot(ends_after=0), TRIGGERS["ESTOP"], 1, Random(1))
