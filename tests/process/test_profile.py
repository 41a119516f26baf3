"""`pilothouse profile` as a process of its own, with the real service that it starts."""

import os
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from api.profiling.run_file import TIMES, read_runs
from tests.support.process import COMMAND, run

SHORT = """\
mock: false
signals:
  gps_accuracy: {for_s: 0.3}
  signal_strength: {low_for_s: 0.4}
  battery_level: {stale_after_s: 0.5}
"""


ONE_OF_EACH_KIND = ("ESTOP", "STALE_DATA", "GPS_LOST", "SIGNAL_LOW")


def test_all_phases_of_a_real_run_are_seen_in_order(tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(SHORT)
    out = tmp_path / "out"

    triggers = [f"--trigger={error}" for error in ONE_OF_EACH_KIND]
    options = ["--runs=1", f"--robot={tmp_path / 'robot.yaml'}", f"--out={out}", *triggers]

    done = subprocess.run(
        [*COMMAND, "profile", *options],
        capture_output=True,
        text=True,
        timeout=55,
        check=False,
    )

    printed = done.stdout
    assert done.returncode == 0, printed + done.stderr
    runs = list(read_runs(out / "runs.csv"))
    assert [measured.trigger for measured in runs] == list(ONE_OF_EACH_KIND)
    for measured in runs:
        times = measured.times
        seen = [name for name in TIMES if name in times and not name.startswith("echo")]
        is_silence = measured.trigger == "STALE_DATA"
        assert set(TIMES) - set(times) == ({"first_bad_s"} if is_silence else set())
        assert [times[name] for name in seen] == sorted(times[name] for name in seen)
        assert times["error_s"] >= times["counts_from_s"] + measured.persistence_s
    assert "Setting: gps_accuracy.for_s is 0.3 (default 15)" in printed
    assert "4 runs, 0 failed" in printed


@contextmanager
def measuring(out: Path) -> Iterator[tuple["subprocess.Popen[str]", int]]:
    """Measure for very long; yields the process, and the id of its service."""
    with subprocess.Popen(
        [*COMMAND, "profile", "--runs", "1000", "--trigger", "ESTOP", "--out", str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    ) as process:
        try:
            assert process.stdout is not None
            assert "run 1 of 1000" in process.stdout.readline()
            children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
            yield process, int(children.read_text())
        finally:
            process.kill()


def has_ended(pid: int) -> bool:
    """Wait up to ten seconds until a process has ended; one that nobody waits for has as well."""
    status = Path(f"/proc/{pid}/stat")
    for _ in range(200):
        if not status.exists() or status.read_text().rpartition(")")[2].split()[0] == "Z":
            return True
        time.sleep(0.05)
    return False


def test_sigterm_ends_the_service_and_keeps_what_was_measured(tmp_path: Path) -> None:
    with measuring(tmp_path / "out") as (process, service):
        process.send_signal(signal.SIGTERM)
        printed, _ = process.communicate(timeout=20)

    assert process.returncode == 130
    assert "0 failed" in printed
    assert (tmp_path / "out" / "report.txt").exists()
    assert has_ended(service)


def test_a_profile_that_is_killed_leaves_no_service_behind(tmp_path: Path) -> None:
    with measuring(tmp_path / "out") as (process, service):
        process.kill()

    assert has_ended(service)


def test_a_model_that_is_invalid_is_told_with_its_line(tmp_path: Path) -> None:
    model = tmp_path / "model.yaml"
    model.write_text("nothing: [")

    code, _, complaints = run("profile", str(model), "--out", str(tmp_path / "out"))

    assert code == 1
    assert f"{model}:1:" in complaints
