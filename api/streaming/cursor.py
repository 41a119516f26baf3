"""The position of a client in frames and events, and the bytes to send next."""

from copy import copy

from api.streaming.client_input import StreamQuery
from api.streaming.encoder import StreamEncoder
from api.streaming.websocket_frames import text_frame
from service.event_log import Gap
from service.frame_feed import Frame, FrameReader
from service.history.event_pages import EventPages, HistoryReader, Told
from service.supervisor import Supervisor

_EVENTS_AT_ONCE = 256
"""Written to a client in one turn, some 100 kB: more than fifty busy clients cause in that time."""


class FrameBytes:
    """Encoded frames and events, made for the first client that needs them and then shared."""

    def __init__(self, encoder: StreamEncoder) -> None:
        self._encoder = encoder
        self._frames: dict[tuple[int, bool, int, frozenset[str]], bytes] = {}
        self._events: dict[int, bytes] = {}

    def frame(self, frame: Frame, skipped: int, topics: frozenset[str]) -> bytes:
        """Return a `state` frame for clients that skipped that many frames before it."""
        key = (frame.seq, frame.full, skipped, topics)
        known = self._frames.get(key)
        if known is None:
            known = self._frames[key] = text_frame(self._encoder.frame(frame, skipped, topics))
        return known

    def event(self, item: Told) -> bytes:
        """Return an `event` or `gap` frame."""
        if isinstance(item, Gap):
            return text_frame(self._encoder.gap(item))
        known = self._events.get(item.id)
        if known is None:
            known = self._events[item.id] = text_frame(self._encoder.event(item))
        return known


class Cursor:
    """A position in the frames and events; everything before it was sent."""

    def __init__(self, supervisor: Supervisor, pages: EventPages, query: StreamQuery) -> None:
        """Start with a complete frame, and after the event that `query` names."""
        self.topics = query.topics
        self.took_complete = False
        """Whether the frame that was taken last is complete."""
        self._frames = FrameReader(supervisor.frames) if query.wants_state else None
        self.events = HistoryReader(pages, query.after, query.epoch) if query.wants_events else None
        """Position in the events; None: the client wants none."""

    @property
    def has_events(self) -> bool:
        """Tell whether there are events after this cursor that need not be loaded first."""
        return self.events is not None and self.events.is_behind

    def take(self, encoded: FrameBytes) -> tuple[bytes, int]:
        """Advance past some events and to the newest frame.

        Returns:
            The WebSocket frames to send, and the number of skipped `state` frames.
        """
        content: list[bytes] = []
        skipped = 0
        if self.events is not None and self.events.is_behind:
            content += map(encoded.event, self.events.take(_EVENTS_AT_ONCE))
        self.took_complete = False
        taken = self._frames.take() if self._frames is not None else None
        if taken is not None:
            frame, skipped = taken
            self.took_complete = frame.full
            content.append(encoded.frame(frame, skipped, self.topics))
        return b"".join(content), skipped

    def begin_frames_anew(self) -> None:
        """Take a complete frame next; the position in the events stays."""
        if self._frames is not None:
            self._frames.begin_anew()

    @property
    def position(self) -> tuple[object, object]:
        """Return a value that is equal for cursors of the same topics at the same position."""
        frames, events = self._frames, self.events
        return frames and frames.position, events and events.position

    def copy(self) -> "Cursor":
        """Return an independent cursor at the same position."""
        other = copy(self)
        other._frames = copy(self._frames)  # noqa: SLF001
        other.events = self.events and self.events.copy()
        return other
