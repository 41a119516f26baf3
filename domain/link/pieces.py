"""A report that is too long for one message: cut into pieces, and put together again."""

from collections.abc import Iterator
from dataclasses import replace

from domain.link.messages import Report, Told

MAX_PIECES = 16
"""Of one report; a complete one of 1,000 nodes takes a fifth of a piece."""


def cut(report: Report, count: int) -> Iterator[Report]:
    """Yield a report in pieces of about the same number of items, in their order.

    Args:
        report: To be cut.
        count: How many pieces: from 2 to `MAX_PIECES`.
    """
    items = report.items
    bounds = [len(items) * number // count for number in range(count + 1)]
    for piece in range(1, count + 1):
        own = items[bounds[piece - 1] : bounds[piece]]
        # Nobody who does not know of pieces may take one for everything.
        yield replace(
            report,
            items=own,
            complete=False,
            piece=piece,
            pieces=count,
            complete_together=report.complete,
        )


class Pieces:
    """Puts the pieces of one device together; what is not whole when another one comes is dropped.

    A report that is dropped is a gap, and what it would have told is in a later one.
    """

    def __init__(self) -> None:
        """Begin without a piece."""
        self._last: Report | None = None
        """The piece that came last; None: none is waited for."""
        self._items: list[Told] = []

    def add(self, report: Report) -> Report | None:
        """Return the report that is whole by this message; None: more pieces are to come."""
        if report.pieces == 1:
            self._forget()
            return report
        if not self._is_next(report):
            self._forget()
            return None
        self._last = report
        self._items += report.items
        if report.piece < report.pieces:
            return None
        items = tuple(self._items)
        self._forget()
        complete = report.complete_together
        return replace(report, items=items, complete=complete, piece=1, pieces=1)

    def _is_next(self, report: Report) -> bool:
        """Tell whether a piece follows the last one, or is the first of a report."""
        if not 2 <= report.pieces <= MAX_PIECES or report.piece > report.pieces:
            return False
        if report.piece == 1:
            self._forget()
            return True
        last = self._last
        return last is not None and _place(report) == _place(last, after=1)

    def _forget(self) -> None:
        self._last = None
        self._items = []


def _place(report: Report, after: int = 0) -> tuple[object, ...]:
    """Return of which report a piece is, and its number."""
    return (
        report.incarnation,
        report.session,
        report.seq,
        report.pieces,
        report.complete_together,
        report.piece + after,
    )
