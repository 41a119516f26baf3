"""Monitors as clients see them."""

from pydantic import Field

from api.http.schemas.base import Json
from domain.snapshot import MonitorView
from domain.timebase import to_seconds


class MonitorJson(Json):
    """A signal that is computed from the readings of another one."""

    signal: str
    of: str = Field(description="The signal that it is computed from")
    statistic: str
    window_s: float | None = Field(description="null: it is a number of readings, `window_n`")
    window_n: int | None
    filled: float = Field(description="How much of the window has passed, from 0 to 1")
    value: float | None = Field(description="null: unknown, since the window has too few readings")
    limits: dict[str, float] = Field(
        description="In force now: `above` or `below`, and `clear_threshold` if it differs"
    )
    limits_because: str | None = Field(
        description="Which of the limits by mode these are, such as `drive_base.FAST` or "
        "`default`; null: they are the same in all modes, or none applies"
    )

    @classmethod
    def of_view(cls, view: MonitorView) -> "MonitorJson":
        """Show `view`."""
        return cls(
            signal=view.signal,
            of=view.of,
            statistic=view.statistic,
            window_s=None if view.window is None else to_seconds(view.window),
            window_n=view.size,
            filled=view.filled,
            value=view.value,
            limits=dict(view.limits),
            limits_because=view.limits_because,
        )


class MonitorsJson(Json):
    """All monitors, in the order of the robot file."""

    items: list[MonitorJson]
