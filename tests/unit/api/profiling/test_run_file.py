import io
from pathlib import Path

import pytest

from api.profiling.run_file import InvalidRunFileError, Run, RunWriter, read_runs
from tests.support.profiled_runs import failed_run, ok_run


def written(*runs: Run) -> str:
    file = io.StringIO(newline="")
    writer = RunWriter(file)
    for run in runs:
        writer.write(run)
    return file.getvalue()


def test_what_was_written_is_read_back(tmp_path: Path) -> None:
    runs = [ok_run(1), failed_run(2), ok_run(3, "GPS_LOST", persistence_s=15)]
    file = tmp_path / "runs.csv"
    file.write_text(written(*runs), encoding="utf-8")

    assert list(read_runs(file)) == runs


def test_a_reason_may_hold_commas_and_quotes(tmp_path: Path) -> None:
    run = Run(1, "ESTOP", "2026-01-01T00:00:00.000Z", 0, {}, 'not seen: "error", pause\nzero')
    file = tmp_path / "runs.csv"
    file.write_text(written(run), encoding="utf-8")

    assert list(read_runs(file)) == [run]


def test_a_run_is_one_line_with_its_status() -> None:
    head, first, second = written(ok_run(1), failed_run(2)).splitlines()

    assert head.startswith("run,trigger,status,reason,started_at,persistence_s,counts_from_s,")
    assert first.startswith("1,ESTOP,ok,,2026-01-01T00:00:00.000Z,0.0,100.000000,100.050000,")
    assert second.startswith('2,ESTOP,failed,"not seen within 2 s: running, resume, drive",')
    assert ",150.000000,,,,0.001000,0.002000" in second


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", r"runs.csv:1: no column run; is it of a profile\?"),
        ("t_s,x_m\n1,2\n", r"runs.csv:1: no column run; is it of a profile\?"),
        (written(ok_run()).replace("150.003", "soon"), r"runs.csv:2: could not convert string"),
        (written(ok_run()).replace("ok", "failed"), r"runs.csv:2: status 'failed' does not fit"),
        (written(ok_run()).rsplit(",", 3)[0], "runs.csv:2: "),
    ],
)
def test_another_file_is_rejected_with_the_line(text: str, complaint: str, tmp_path: Path) -> None:
    file = tmp_path / "runs.csv"
    file.write_text(text, encoding="utf-8")

    with pytest.raises(InvalidRunFileError, match=complaint):
        list(read_runs(file))
