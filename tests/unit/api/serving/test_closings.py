import pytest

from api.serving.closings import Closings, ClosingsCollector


def test_a_flood_of_closings_fills_no_log(caplog: pytest.LogCaptureFixture) -> None:
    closings = Closings()

    for number in range(3_000):
        closings.note("full", "192.0.2.1", number / 1_000)

    assert len(caplog.messages) == 3
    assert "999 more" in caplog.messages[1]
    assert closings.counts["full"] == 3_000


def test_the_counts_are_a_metric() -> None:
    closings = Closings()
    closings.note("head", "192.0.2.1", 0.0)

    (metric,) = ClosingsCollector(closings).collect()

    assert {s.labels["reason"]: s.value for s in metric.samples}["head"] == 1
