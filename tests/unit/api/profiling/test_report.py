from api.profiling.report import report_json, report_lines
from tests.support.profiled_runs import failed_run, ok_run

SETUP = {
    "version": "1.2.3",
    "started_at": "2026-01-01T00:00:00Z",
    "machine": {"CPU": "Z80", "cores": "1"},
    "load": {"average before": "0.25", "scheduling": "normal, nice 0"},
    "changed_settings": ["gps_accuracy.for_s is 0.5 (default 15)"],
}


def test_the_report_has_a_table_for_each_trigger() -> None:
    lines = list(report_lines([ok_run(1), ok_run(1, "GPS_LOST", persistence_s=15)], {}))

    assert "ESTOP, 1 run" in lines
    assert "GPS_LOST, 1 run, persistence 15 s subtracted" in lines
    rows = [line.split() for line in lines if line.strip().startswith("bad reading to zero")]
    assert [row[5:] for row in rows] == [["1", "0", *["2.00"] * 6, "0.00"]] * 2


def test_machine_load_and_changed_times_are_named_first() -> None:
    lines = list(report_lines([ok_run()], SETUP))

    assert lines[:4] == [
        "Pilothouse 1.2.3, measured at 2026-01-01T00:00:00Z",
        "Machine: CPU Z80, cores 1",
        "Load: average before 0.25, scheduling normal, nice 0",
        "Setting: gps_accuracy.for_s is 0.5 (default 15)",
    ]


def test_failed_runs_are_listed_with_their_reason() -> None:
    lines = list(report_lines([ok_run(1), failed_run(2)], {}))

    assert lines[-2:] == [
        "2 runs, 1 failed",
        "  ESTOP, run 2: not seen within 2 s: running, resume, drive",
    ]


def test_p99_of_few_runs_is_called_what_it_is() -> None:
    words = "With fewer than 100 runs, p99 is little more than the maximum."

    assert words in list(report_lines([ok_run()], {}))
    assert words not in list(report_lines([ok_run(number) for number in range(100)], {}))


def test_a_report_without_runs_says_so() -> None:
    assert list(report_lines([], {}))[-1] == "0 runs, 0 failed"


def test_the_report_for_programs_has_the_same_figures() -> None:
    found = report_json([ok_run(1), failed_run(2)], SETUP)

    assert (found["runs"], found["failed"], found["setup"]) == (2, 1, SETUP)
    assert found["failures"][0]["run"] == 2
    drive = next(one for one in found["latencies"] if one["latency"] == "good_to_drive")
    assert drive == {
        "trigger": "ESTOP",
        "latency": "good_to_drive",
        "count": 2,
        "failed": 1,
        "success_percent": 50.0,
        "min_ms": 3.0,
        "mean_ms": 3.0,
        "p50_ms": 3.0,
        "p95_ms": 3.0,
        "p99_ms": 3.0,
        "max_ms": 3.0,
        "std_ms": 0.0,
    }
