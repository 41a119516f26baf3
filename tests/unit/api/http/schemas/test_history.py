"""A point of a history as clients see it."""

from api.http.schemas.history import HistoryPointJson
from domain.timebase import seconds
from service.storage.trends.history import TrendPoint
from tests.support.manual_clock import ManualClock


def test_a_point_is_shown_with_its_time_in_utc() -> None:
    point = TrendPoint(seconds(1.25), 1.0, 3.0, 2.0, 1.5, "HOT")

    shown = HistoryPointJson.of(point, ManualClock()).model_dump()

    assert shown == {
        "at": "2026-01-01T00:00:01.250Z",
        "min": 1.0,
        "max": 3.0,
        "mean": 2.0,
        "last": 1.5,
        "error": "HOT",
    }
