"""The history of a signal as clients see it."""

from pydantic import Field

from api.http.schemas.base import Json, Timestamp, timestamp
from service.clock import Clock
from service.storage.trends.history import TrendPoint


class HistoryPointJson(Json):
    """What a signal was in one piece of time: all readings in it count, also a single spike."""

    at: Timestamp = Field(description="Time of the first reading")
    min: float | str = Field(
        description="Least value; false is 0 and true is 1; of an enumeration, the best member"
    )
    max: float | str = Field(description="Greatest value; of an enumeration, the worst member")
    mean: float | None = Field(description="Mean of all readings; null for an enumeration")
    last: float | str = Field(description="The last reading")
    error: str | None = Field(description="The worst error of the value in force at a reading")

    @classmethod
    def of(cls, point: TrendPoint, clock: Clock) -> "HistoryPointJson":
        """Show `point`."""
        return cls(
            at=timestamp(clock, point.at),
            min=point.low,
            max=point.high,
            mean=point.mean,
            last=point.last,
            error=point.error,
        )


class SignalHistoryJson(Json):
    """The history of a signal, the oldest point first; where there was no reading is no point."""

    items: list[HistoryPointJson]
    tier_s: float = Field(
        description="Width of the buckets that the points are made of; 0: of single readings"
    )
