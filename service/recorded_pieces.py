"""Pieces of what was recorded: each can be replayed without what was before it.

A piece begins where a run of the service begins, or with a checkpoint. Where steps were lost, one
ends; the next begins with the first checkpoint after that.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from domain.errors import PilothouseError
from domain.inputs import Restored
from domain.timebase import Instant
from service.codec.codec import STEPS
from service.codec.recorded_step import RecordedStep
from service.storage.journal import Boot, EventQuery
from service.storage.sqlite.recorded_log import RecordedCheckpoint, RecordedLog, RecordedRun


class NothingRecordedError(PilothouseError):
    """A record in which there is nothing that can be replayed."""

    code = "NOTHING_RECORDED"


@dataclass(frozen=True, slots=True)
class Piece:
    """Steps of one run without a gap, and the state of the core before them."""

    run: int
    boot: Boot
    state: bytes | None
    """The checkpoint that it begins with; None: it begins with the run."""
    first: int
    """Number of its first step."""
    steps: Iterator[RecordedStep]


def pieces_of(
    log: RecordedLog, version: str, first_event: int | None, last_event: int | None
) -> Iterator[Piece]:
    """Yield the pieces of a log that have the wanted events, in order.

    Args:
        log: Of a folder.
        version: This release of Pilothouse; of other releases, no checkpoint can be used.
        first_event: Id of the first event that is wanted; None: all from the start. A piece may
            begin earlier.
        last_event: Id of the last event that is wanted; None: all to the end.

    Raises:
        NothingRecordedError: The log has no such event, or nothing that can be replayed.
    """
    begin = (0, None) if first_event is None else _place_of(log, first_event)
    end = None if last_event is None else _place_of(log, last_event)
    starts = [
        start
        for run in log.runs()
        if run.number >= begin[0] and (end is None or run.number <= end[0])
        for start in _starts_in(log, run, version, begin[1] if run.number == begin[0] else None)
    ]
    if not starts:
        raise NothingRecordedError(
            "nothing of it can be replayed: neither the start of the run nor a checkpoint of"
            f" release {version} is in the record"
        )
    for start in starts:
        steps = _Steps(log, start, last_event)
        checkpoint = start.checkpoint
        state = None if checkpoint is None else log.state(checkpoint)
        yield Piece(start.run.number, start.run.boot, state, start.after_step + 1, iter(steps))
        if steps.is_last:
            return


@dataclass(frozen=True, slots=True)
class _Start:
    """Where a replay can start."""

    run: RecordedRun
    after_step: int
    """Number of the last step before it."""
    at: Instant
    checkpoint: RecordedCheckpoint | None
    """None: the start of the run."""
    until_step: int | None
    """Number of the last step before a hole; None: there is none."""


def _place_of(log: RecordedLog, event: int) -> tuple[int, Instant]:
    """Return the run and the time of an event.

    Raises:
        NothingRecordedError: The log does not have it.
    """
    found = log.events(EventQuery(after=event - 1, limit=1))
    if not found or found[0].id != event:
        raise NothingRecordedError(f"event {event} is not in the record")
    return found[0].boot, found[0].at


def _starts_in(
    log: RecordedLog, run: RecordedRun, version: str, before: Instant | None
) -> Sequence[_Start]:
    """Return where the pieces of a run start; with `before`, the first one is as late as it can be.

    Args:
        log: Of a folder.
        run: In the log.
        version: Of checkpoints that can be used.
        before: The first start is before this time; None: it is the first one that there is.
    """
    ends = [hole.after_step for hole in log.holes() if hole.run == run.number]

    def start(after_step: int, at: Instant, checkpoint: RecordedCheckpoint | None) -> _Start:
        until = min((end for end in ends if end > after_step), default=None)
        return _Start(run, after_step, at, checkpoint, until)

    starts = [
        start(checkpoint.step, checkpoint.at, checkpoint)
        for checkpoint in log.checkpoints()
        if checkpoint.run == run.number and checkpoint.version == version
    ]
    number, line = next(log.lines(run.number), (0, b""))
    if line and isinstance(STEPS.decode(line).given, Restored):
        starts.insert(0, start(number - 1, run.boot.started_at, None))
    if before is not None:
        earlier = sum(one.at < before for one in starts)
        starts = starts[earlier - 1 :] if earlier else []
    # From the first start before a hole, all is replayed up to the hole.
    return list({one.until_step: one for one in reversed(starts)}.values())[::-1]


class _Steps:
    """The steps from a start to a hole, the wanted last event or the end of the run."""

    def __init__(self, log: RecordedLog, start: _Start, last_event: int | None) -> None:
        self._log = log
        self._start = start
        self._last_event = last_event
        self.is_last = False
        """Whether the last event was reached."""

    def __iter__(self) -> Iterator[RecordedStep]:
        start = self._start
        for number, line in self._log.lines(start.run.number, start.after_step):
            if start.until_step is not None and number > start.until_step:
                return
            step = STEPS.decode(line)
            yield step
            if self._last_event is not None and step.events:
                self.is_last = step.events[-1].id >= self._last_event
                if self.is_last:
                    return
