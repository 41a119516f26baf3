"""Text of one event."""

from collections.abc import Mapping

from pydantic_core import to_json

from api.http.schemas.base import timestamp
from domain.events.event import RecordedEvent
from service.clock import Clock


def event_text(event: RecordedEvent, epoch: str, clock: Clock) -> str:
    """Return an `event` frame, as it stands in the log and in simulations too."""
    shown = {
        "type": "event",
        "epoch": epoch,
        "id": event.id,
        "at": timestamp(clock, event.at),
        "kind": event.kind,
        "cause": event.cause,
        "actor": event.actor,
        "data": event.data,
        "words": event.event.words,
        "notable": event.event.notable,
    }
    # A node may report a parameter that is NaN, which JSON does not know.
    return to_json(shown, inf_nan_mode="null", fallback=_plain).decode()


def _plain(value: object) -> object:
    """Return what JSON can hold instead of `value`, such as a read-only mapping."""
    return dict(value) if isinstance(value, Mapping) else str(value)
