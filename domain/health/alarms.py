"""What operators have yet to see: which errors nobody acknowledged, also over a restart."""

from domain.health.alarm import QUIET, Alarm
from domain.kept import KeptUnacknowledged
from domain.outbox import Outbox
from domain.snapshot import ErrorKey, ErrorState, ErrorView

MAX_RETURNED = 500
"""Errors that ended unacknowledged and are still told; of more, the oldest count as seen. What a
robot of ten thousand nodes tells after its network failed has to stay readable."""

MAX_KEPT = 1_000
"""Unacknowledged errors that survive a restart; those beyond are found again, or forgotten."""


class Alarms:
    """The errors that are not quiet, as they are announced."""

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox
        self._alarms: dict[ErrorKey, Alarm] = {}
        self._returned: dict[ErrorKey, None] = {}
        """Those that ended unacknowledged, the oldest first."""
        self._from_start: set[ErrorKey] = set()
        """Those that are on since the start: so each robot begins, which nobody has to see."""
        self._kept: set[ErrorKey] = set()
        self._keeps = False

    def __getitem__(self, key: ErrorKey) -> Alarm:
        """Return how an error is announced."""
        return self._alarms.get(key, QUIET)

    def is_from_start(self, key: ErrorKey) -> bool:
        """Tell whether an error is on since the start."""
        return key in self._from_start

    def mark_start(self) -> None:
        """Take what is on now as how each robot begins."""
        self._from_start = {key for key, alarm in self._alarms.items() if alarm.state.is_on}
        self._keeps = True

    def take_as_start(self, key: ErrorKey) -> None:
        """Take an error that is about to be raised as how the robot begins."""
        self._from_start.add(key)

    def note_told(self, key: ErrorKey) -> None:
        """Note that it is told that an error is on."""
        self._from_start.discard(key)

    def discard(self, key: ErrorKey) -> None:
        """Forget an error that is on since the start."""
        self._from_start.discard(key)
        self._alarms.pop(key, None)

    def restore(self, kept: KeptUnacknowledged) -> None:
        """Note that nobody saw an error of an earlier run; it is kept as it was."""
        key = ErrorKey(kept.part, kept.error)
        self._from_start.discard(key)
        self._kept.add(key)

    @property
    def returned(self) -> tuple[ErrorKey, ...]:
        """Return the errors that ended unacknowledged, the oldest first."""
        return tuple(self._returned)

    def put(self, view: ErrorView, alarm: Alarm, *, is_announced: bool = True) -> ErrorKey | None:
        """Note how an error is announced now.

        Args:
            view: The error as it is shown with it.
            alarm: How it is announced.
            is_announced: Whether it is announced by itself, and so kept until somebody sees it.

        Returns:
            An error that has returned and counts as seen, since there are too many; None: none.
        """
        key = view.key
        if alarm == QUIET:
            self._alarms.pop(key, None)
        else:
            self._alarms[key] = alarm
        if not alarm.state.is_on:
            self._from_start.discard(key)
        self._keep(view, is_unseen=alarm.unseen and is_announced)
        if alarm.state is not ErrorState.RETURNED:
            self._returned.pop(key, None)
        elif key not in self._returned:
            self._returned[key] = None
            if len(self._returned) > MAX_RETURNED:
                return next(iter(self._returned))
        return None

    def keep_no_longer(self, key: ErrorKey) -> None:
        """Forget over a restart that nobody saw an error."""
        if key in self._kept:
            self._kept.discard(key)
            self._outbox.forget(KeptUnacknowledged, key.name)

    def _keep(self, view: ErrorView, *, is_unseen: bool) -> None:
        """Keep over a restart that nobody saw an error, from when it was raised."""
        key = view.key
        if not is_unseen:
            self.keep_no_longer(key)
        elif self._keeps and key not in self._kept and key not in self._from_start:
            self._keep_new(view)

    def _keep_new(self, view: ErrorView) -> None:
        if len(self._kept) >= MAX_KEPT:
            return
        part, error = view.key
        since = view.since or self._outbox.now
        self._kept.add(view.key)
        kept = KeptUnacknowledged(part, error, view.message, since, view.value, view.threshold)
        self._outbox.keep(kept)
