"""`pilothouse profile` with a robot whose time passes only while it is watched."""

import json
import sys
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest

from api.cli import profile_run
from api.cli.profile_run import ProfileOptions, analyse, measure
from api.profiling.live_robot import NotSimulatedError
from api.profiling.run_file import read_runs
from tests.support.profiled_robot import SETTINGS, ProfiledRobot


class Bench:
    """The robot that is measured, and how its service was started."""

    def __init__(self) -> None:
        self.robot = ProfiledRobot()
        self.serve: list[Sequence[str]] = []
        self.why_not: Exception | None = None

    @asynccontextmanager
    async def own_service(self, options: Sequence[str], _: Path) -> AsyncIterator[str]:
        self.serve.append(options)
        yield "http://robot"

    @asynccontextmanager
    async def live_robot(self, _: str) -> AsyncIterator[ProfiledRobot]:
        if self.why_not:
            raise self.why_not
        yield self.robot


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Bench:
    bench = Bench()
    monkeypatch.setattr(profile_run, "own_service", bench.own_service)
    monkeypatch.setattr(profile_run, "live_robot", bench.live_robot)
    return bench


def options(out: Path | None, **more: Any) -> ProfileOptions:  # noqa: ANN401  # of any type
    usual: dict[str, Any] = {"model": None, "robot": None, "runs": 2, "triggers": ("ESTOP",)}
    return ProfileOptions(**{**usual, "out": out, "form": "text", "plot": False, **more})


def test_raw_data_setup_and_report_are_kept(
    bench: Bench, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "new" / "folder"

    assert measure(options(out)) == 0

    printed = capsys.readouterr()
    assert [run.number for run in read_runs(out / "runs.csv")] == [1, 2]
    assert json.loads((out / "setup.json").read_text())["settings"] == SETTINGS
    assert (out / "report.txt").read_text() == printed.out
    assert json.loads((out / "report.json").read_text())["failed"] == 0
    assert "2 runs, 0 failed" in printed.out
    assert f"results are in {out}" in printed.err
    assert "run 1 of 2: ESTOP, 0:03 min left" in printed.err
    assert bench.robot.drives == 2


def test_without_a_robot_file_signals_are_not_mocked(bench: Bench, tmp_path: Path) -> None:
    assert measure(options(tmp_path, runs=1)) == 0

    assert bench.serve == [
        ["--robot", str(tmp_path / "robot.yaml"), "--data", str(tmp_path / "data")]
    ]
    assert "mock: false" in (tmp_path / "robot.yaml").read_text()


def test_model_and_robot_file_are_those_of_the_service(bench: Bench, tmp_path: Path) -> None:
    asked = options(tmp_path, runs=1, model=Path("m.yaml"), robot=Path("r.yaml"))

    assert measure(asked) == 0

    assert bench.serve == [["m.yaml", "--robot", "r.yaml", "--data", str(tmp_path / "data")]]


def test_times_that_differ_from_the_defaults_are_named(
    bench: Bench, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shorter = {**SETTINGS, "gps_accuracy": {**SETTINGS["gps_accuracy"], "for_s": 0.5}}
    bench.robot = ProfiledRobot(settings=shorter)

    assert measure(options(tmp_path, runs=1, triggers=("GPS_LOST",))) == 0

    assert "Setting: gps_accuracy.for_s is 0.5 (default 15)" in capsys.readouterr().out


def test_without_a_folder_a_new_one_is_made(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)

    assert measure(options(None, runs=1)) == 0

    (folder,) = tmp_path.iterdir()
    assert folder.name.startswith("profile-")


def test_a_failed_run_fails_the_profile(
    bench: Bench, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bench.robot = ProfiledRobot(deaf_to=frozenset({"ESTOP"}))

    assert measure(options(tmp_path, triggers=("ESTOP", "BATTERY_LOW"))) == 1

    assert "4 runs, 2 failed\n  ESTOP, run 1: not seen within 2 s" in capsys.readouterr().out


def test_earlier_data_is_not_overwritten(
    bench: Bench, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "runs.csv").write_text("precious")

    assert measure(options(tmp_path)) == 2

    assert (tmp_path / "runs.csv").read_text() == "precious"
    assert "choose another --out" in capsys.readouterr().err


def test_a_folder_that_cannot_be_made_is_said(
    bench: Bench, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")

    assert measure(options(tmp_path / "file")) == 2

    assert capsys.readouterr().err == f"pilothouse: {tmp_path / 'file'}: File exists\n"


def test_a_reader_that_closes_the_pipe_leaves_the_report_in_its_file(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def closed(text: str, **_: object) -> None:
        raise BrokenPipeError(32, "Broken pipe")

    monkeypatch.setattr(sys.stdout, "write", closed)

    with pytest.raises(BrokenPipeError):
        measure(options(tmp_path))

    assert "2 runs, 0 failed" in (tmp_path / "report.txt").read_text()


def test_ctrl_c_keeps_and_reports_what_was_measured(
    bench: Bench,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async def interrupted(length_m: float) -> None:
        if bench.robot.drives == 2:
            raise KeyboardInterrupt
        await ProfiledRobot.drive(bench.robot, length_m)

    monkeypatch.setattr(bench.robot, "drive", interrupted)

    with pytest.raises(KeyboardInterrupt):
        measure(options(tmp_path, runs=9))

    assert len(list(read_runs(tmp_path / "runs.csv"))) == 2
    assert "2 runs, 0 failed" in capsys.readouterr().out
    assert (tmp_path / "report.txt").exists()


def test_a_service_that_ends_fails_and_keeps_what_was_measured(
    bench: Bench, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bench.robot = ProfiledRobot(ends_after=1)

    assert measure(options(tmp_path, runs=9)) == 1

    printed = capsys.readouterr()
    assert "1 run, 0 failed" in printed.out
    assert "pilothouse: gone" in printed.err


def test_a_robot_that_is_real_is_not_measured(
    bench: Bench, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bench.why_not = NotSimulatedError("not simulated: vehicle")

    assert measure(options(tmp_path)) == 1

    assert "not simulated: vehicle" in capsys.readouterr().err
    assert not bench.robot.drives


def test_without_matplotlib_nothing_is_measured_in_vain(
    bench: Bench,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)

    assert measure(options(tmp_path / "out", plot=True)) == 2

    assert "install pilothouse[plot]" in capsys.readouterr().err
    assert not bench.serve
    assert not (tmp_path / "out").exists()


def test_the_plot_is_drawn_on_request(bench: Bench, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")

    assert measure(options(tmp_path, plot=True)) == 0

    assert (tmp_path / "latency.png").exists()


def test_the_analysis_of_raw_data_is_the_report_of_the_profile(
    bench: Bench, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    measure(options(tmp_path))
    first = capsys.readouterr().out

    assert analyse([tmp_path / "runs.csv"], None, "text", plot=False) == 0
    assert capsys.readouterr().out == first

    assert analyse([tmp_path / "runs.csv"], tmp_path / "again", "json", plot=False) == 0
    assert json.loads(capsys.readouterr().out)["setup"]["settings"] == SETTINGS
    assert (tmp_path / "again" / "report.txt").read_text() == first


def test_several_profiles_are_analysed_together(
    bench: Bench, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    measure(options(tmp_path / "a"))
    bench.robot = ProfiledRobot(deaf_to=frozenset({"ESTOP"}))
    measure(options(tmp_path / "b"))
    capsys.readouterr()

    files = [tmp_path / "a" / "runs.csv", tmp_path / "b" / "runs.csv"]
    assert analyse(files, None, "text", plot=False) == 1

    printed = capsys.readouterr().out
    assert "ESTOP, 4 runs" in printed
    assert "4 runs, 2 failed" in printed
    assert printed.startswith("Pilothouse")
    assert "Machine: " in printed
    assert "Load: " not in printed


def test_the_setup_of_profiles_that_differ_is_left_out(
    bench: Bench, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    measure(options(tmp_path / "a"))
    measure(options(tmp_path / "b"))
    setup = tmp_path / "b" / "setup.json"
    setup.write_text(json.dumps({**json.loads(setup.read_text()), "version": "0.0"}))
    capsys.readouterr()

    files = [tmp_path / "a" / "runs.csv", tmp_path / "b" / "runs.csv"]
    assert analyse(files, None, "text", plot=False) == 0

    assert capsys.readouterr().out.startswith("Latencies in ms")


@pytest.mark.parametrize("text", [None, "[1]", "{}", "no JSON"])
def test_raw_data_without_its_setup_is_analysed_all_the_same(
    bench: Bench, tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str | None
) -> None:
    measure(options(tmp_path))
    setup = tmp_path / "setup.json"
    setup.unlink() if text is None else setup.write_text(text)
    capsys.readouterr()

    assert analyse([tmp_path / "runs.csv"], None, "text", plot=False) == 0

    assert capsys.readouterr().out.startswith("Latencies in ms")


def test_what_cannot_be_analysed_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "other.csv").write_text("x_m,y_m\n1,2\n")

    assert analyse([tmp_path / "none.csv"], None, "text", plot=False) == 2
    assert analyse([tmp_path / "other.csv"], None, "text", plot=False) == 2
    assert analyse([tmp_path / "other.csv"], None, "text", plot=True) == 2

    complaints = capsys.readouterr().err
    assert f"{tmp_path / 'none.csv'}: No such file or directory" in complaints
    assert "other.csv:1: no column run" in complaints
    assert "needs --out" in complaints
