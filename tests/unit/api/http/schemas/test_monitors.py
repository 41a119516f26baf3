"""Monitors as clients see them."""

from api.http.schemas.monitors import MonitorJson
from domain.snapshot import MonitorView
from domain.timebase import seconds


def test_a_window_is_a_time_or_a_number_of_readings() -> None:
    view = MonitorView("rate", "scan", "rate", seconds(2.5), None, 0.5, 8.0, {"below": 5.0}, None)
    shown = MonitorJson.of_view(view)
    assert (shown.window_s, shown.window_n, shown.value) == (2.5, None, 8.0)

    view = MonitorView("mean", "scan", "mean", None, 9, 1.0, None, {}, "drive_base.FAST")
    shown = MonitorJson.of_view(view)
    assert (shown.window_s, shown.window_n, shown.value) == (None, 9, None)
    assert shown.limits_because == "drive_base.FAST"
