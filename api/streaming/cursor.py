"""How far a client has got in what is published, and the bytes of what comes next."""

from copy import copy

from api.streaming.client_input import StreamQuery
from api.streaming.encoder import StreamEncoder
from api.streaming.websocket_frames import text_frame
from domain.events.event import RecordedEvent
from service.event_log import EventReader, Gap
from service.frame_feed import Frame, FrameReader
from service.supervisor import Supervisor

_EVENTS_AT_ONCE = 32


class FrameBytes:
    """Bytes of what is new, made for the first who needs them, and then the same for all."""

    def __init__(self, encoder: StreamEncoder) -> None:
        self._encoder = encoder
        self._frames: dict[tuple[int, bool, int, frozenset[str]], bytes] = {}
        self._events: dict[int, bytes] = {}

    def frame(self, frame: Frame, skipped: int, topics: frozenset[str]) -> bytes:
        """Return a `state` frame for those who missed so many before it."""
        key = (frame.seq, frame.full, skipped, topics)
        known = self._frames.get(key)
        if known is None:
            known = self._frames[key] = text_frame(self._encoder.frame(frame, skipped, topics))
        return known

    def event(self, item: RecordedEvent | Gap) -> bytes:
        """Return an `event` or `gap` frame."""
        if isinstance(item, Gap):
            return text_frame(self._encoder.gap(item))
        known = self._events.get(item.id)
        if known is None:
            known = self._events[item.id] = text_frame(self._encoder.event(item))
        return known


class Cursor:
    """A cursor in the frames and events; what is before it has been sent."""

    def __init__(self, supervisor: Supervisor, query: StreamQuery) -> None:
        """Begin with a complete frame, and behind the event that `query` names."""
        self.topics = query.topics
        self._frames = FrameReader(supervisor.frames) if query.wants_state else None
        self._events = (
            EventReader(supervisor.events, query.after, query.epoch) if query.wants_events else None
        )

    @property
    def has_events(self) -> bool:
        """Tell whether there are events behind this cursor."""
        return self._events is not None and self._events.is_behind

    def take(self, encoded: FrameBytes) -> tuple[bytes, int]:
        """Move on, past some events and to the newest frame.

        Returns:
            The WebSocket frames to send for that, and how many `state` frames are skipped by it.
        """
        content: list[bytes] = []
        skipped = 0
        if self._events is not None and self._events.is_behind:
            content += map(encoded.event, self._events.take(_EVENTS_AT_ONCE))
        taken = self._frames.take() if self._frames is not None else None
        if taken is not None:
            frame, skipped = taken
            content.append(encoded.frame(frame, skipped, self.topics))
        return b"".join(content), skipped

    def begin_frames_anew(self) -> None:
        """Take a complete frame next; events go on where they are."""
        if self._frames is not None:
            self._frames.begin_anew()

    @property
    def position(self) -> tuple[object, object]:
        """Return what tells this cursor from others of the same topics."""
        frames, events = self._frames, self._events
        return frames and frames.position, events and events.position

    def copy(self) -> "Cursor":
        """Return a cursor of its own that begins here."""
        other = copy(self)
        other._frames, other._events = copy(self._frames), copy(self._events)  # noqa: SLF001
        return other
