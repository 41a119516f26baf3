import pytest

from api.serving.closings import Closings, ClosingsCollector


def test_each_closed_connection_is_counted_and_told_with_its_address(
    caplog: pytest.LogCaptureFixture,
) -> None:
    closings = Closings()

    for _ in range(3):
        closings.note("full", "192.0.2.1")

    assert caplog.messages == ["closed a connection of 192.0.2.1: full"] * 3
    assert closings.counts == {"full": 3}


def test_the_counts_are_a_metric() -> None:
    closings = Closings()
    closings.note("head", "192.0.2.1")

    (metric,) = ClosingsCollector(closings).collect()

    assert {s.labels["reason"]: s.value for s in metric.samples}["head"] == 1
