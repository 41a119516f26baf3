import statistics
from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from api.profiling.analysis import LATENCIES, Summary, figures_of, latency_ms, summaries
from api.profiling.run_file import Run
from tests.support.profiled_runs import failed_run, ok_run


def by_latency(runs: list[Run]) -> dict[str, Summary]:
    return {summary.latency.key: summary for summary in summaries(runs)}


def test_the_persistence_is_subtracted_from_stops_and_not_from_starts() -> None:
    run = ok_run(stop_s=0.004, start_s=0.006, persistence_s=15)

    taken = {latency.key: latency_ms(run, latency) for latency in LATENCIES}

    assert taken == pytest.approx(
        {
            "bad_to_error": 4,
            "bad_to_pause": 4,
            "bad_to_zero": 4,
            "good_to_running": 6,
            "good_to_resume": 6,
            "good_to_drive": 6,
        }
    )


def test_a_failed_run_counts_as_failed_in_what_it_did_not_see() -> None:
    found = by_latency([ok_run(1), ok_run(2), failed_run(3), ok_run(4)])

    assert (found["bad_to_zero"].count, found["bad_to_zero"].failed) == (4, 0)
    assert (found["good_to_drive"].count, found["good_to_drive"].failed) == (4, 1)
    assert found["good_to_drive"].as_json()["success_percent"] == 75
    assert found["good_to_drive"].figures["max"] == pytest.approx(3)


def test_what_was_seen_before_it_was_due_counts_as_failed() -> None:
    found = by_latency([ok_run(1), ok_run(2, stop_s=-0.5, persistence_s=15)])

    assert (found["bad_to_error"].count, found["bad_to_error"].failed) == (2, 1)
    assert found["bad_to_error"].figures["min"] == pytest.approx(2)


def test_a_trigger_that_always_fails_has_no_figures() -> None:
    nothing = Run(1, "ESTOP", "2026-01-01T00:00:00.000Z", 0, {}, "it did not drive")

    found = by_latency([nothing])

    assert found["bad_to_error"].as_json() == {
        "trigger": "ESTOP",
        "latency": "bad_to_error",
        "count": 1,
        "failed": 1,
        "success_percent": 0,
    }
    assert (found["echo"].count, found["echo"].failed) == (2, 2)


def test_echoes_of_a_trigger_are_taken_together() -> None:
    echo = by_latency([ok_run(1), ok_run(2)])["echo"]

    assert (echo.count, echo.figures["min"], echo.figures["max"]) == (4, 1, 2)


def test_triggers_are_kept_apart_in_the_order_of_the_runs() -> None:
    found = list(summaries([ok_run(1, "ESTOP"), ok_run(1, "GPS_LOST"), ok_run(2, "ESTOP")]))

    assert [summary.trigger for summary in found] == ["ESTOP"] * 7 + ["GPS_LOST"] * 7


@given(st.lists(st.floats(0, 1e4), min_size=2, max_size=300))
def test_percentiles_are_those_of_numpy_and_of_statistics(values: list[float]) -> None:
    found = figures_of(values)

    cuts = statistics.quantiles(values, n=100, method="inclusive")
    for share in (50, 95, 99):
        assert found[f"p{share}"] == pytest.approx(float(np.percentile(values, share)))
        assert found[f"p{share}"] == pytest.approx(cuts[share - 1])
    assert found["std"] == pytest.approx(statistics.pstdev(values), abs=1e-6)


def test_figures_do_not_depend_on_the_order() -> None:
    values = [Random(1).uniform(0, 10) for _ in range(100)]

    assert figures_of(values) == pytest.approx(figures_of(sorted(values)))
