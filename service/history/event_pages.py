"""Earlier events in pages, for readers that follow the log from where they were cut off."""

from collections import OrderedDict
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from typing import TypeAlias

from domain.events.event import RecordedEvent
from service.event_log import EventReader, Gap
from service.history.event_gaps import with_gaps
from service.history.event_history import EventHistory, ToldEvent
from service.storage.journal import EventQuery

EVENTS_PER_PAGE = 256
_PAGES_KEPT = 32
"""Some 4 MB: many clients that come back after a restart ask for the same pages."""

Told: TypeAlias = ToldEvent | Gap


@dataclass(frozen=True, slots=True)
class Page:
    """Some events that follow each other, and gaps between them."""

    items: Sequence[Told]
    last: int
    """Id up to which nothing is left out."""


class EventPages:
    """Reads pages from the journal; the newest ones are kept for other readers."""

    def __init__(self, history: EventHistory) -> None:
        self.history = history
        self._kept: OrderedDict[tuple[int, str], Page] = OrderedDict()

    async def after(self, number: int, epoch: str) -> Page:
        """Return the events after an id; pages of different readers soon begin at the same ids.

        Args:
            number: An id that memory no longer has the successor of.
            epoch: Run that the id belongs to.

        Raises:
            StorageDegradedError: The journal cannot be read.
        """
        key = number, epoch
        known = self._kept.get(key)
        if known is not None:
            self._kept.move_to_end(key)
            return known
        log = self.history.log
        end, limit = log.oldest, EVENTS_PER_PAGE - number % EVENTS_PER_PAGE
        found = await self.history.stored_before(EventQuery(after=number, limit=limit), end)
        is_full = len(found) == limit
        last = found[-1].id if is_full else end - 1
        page = Page(tuple(with_gaps(found, number + 1, last, epoch, log.epoch)), last)
        if is_full:
            self._kept[key] = page
            while len(self._kept) > _PAGES_KEPT:
                self._kept.popitem(last=False)
        return page


class HistoryReader:
    """The position of one reader in the events of all runs; it gets each, or a gap for it.

    From memory it takes at once. What memory has no longer is read a page at a time, by `load`.
    """

    def __init__(
        self, pages: EventPages, after: int | None = None, epoch: str | None = None
    ) -> None:
        """Start after a cursor, as `EventReader` does."""
        log = pages.history.log
        self._pages = pages
        self._recent = EventReader(log, after, epoch)
        self._epoch = log.epoch
        """Run of the event that was taken last."""
        if after is not None and not log.is_foreign(after, epoch):
            self._epoch = epoch or log.epoch_of(after)
        self._page = Page((), 0)
        self._taken = 0
        """Items of the page that were taken."""

    @property
    def position(self) -> tuple[int, Gap | None]:
        """Return a value that is equal for readers at the same position in the same log."""
        return self._recent.position

    @property
    def needs_page(self) -> bool:
        """Tell whether a page has to be loaded before anything more can be taken."""
        return (
            self._pages.history.reaches_back
            and self._taken == len(self._page.items)
            and self._recent.is_cut_off
        )

    @property
    def is_behind(self) -> bool:
        """Tell whether there are events, or a gap, to take at once."""
        if self._taken < len(self._page.items) or self._recent.has_lost:
            return True
        return self._recent.is_behind and not self.needs_page

    def take(self, limit: int) -> list[Told]:
        """Return the next items that are there: at most `limit` events, and gaps before them."""
        lost = self._recent.take_lost()
        if lost is not None:
            return [lost]
        if self._taken < len(self._page.items):
            return self._take_of_page(limit)
        if self.needs_page:
            return []
        self._epoch = self._pages.history.log.epoch
        return [*self._recent.take(limit)]

    async def load(self) -> None:
        """Load the page that is needed.

        Raises:
            StorageDegradedError: The journal cannot be read.
        """
        self._use(await self._pages.after(self._recent.at, self._epoch))

    def skip(self) -> None:
        """Go on with what memory has, since the journal cannot be read; the gap is told."""
        log = self._pages.history.log
        missing = Gap(self._recent.at + 1, log.oldest - 1, self._epoch)
        self._use(Page((missing,), log.oldest - 1))

    def copy(self) -> "HistoryReader":
        """Return an independent reader at the same position."""
        other = copy(self)
        other._recent = copy(self._recent)  # noqa: SLF001
        return other

    def _use(self, page: Page) -> None:
        self._page, self._taken = page, 0

    def _take_of_page(self, limit: int) -> list[Told]:
        taken = list(self._page.items[self._taken : self._taken + limit])
        self._taken += len(taken)
        last = taken[-1]
        at = last.last if isinstance(last, Gap) else last.id
        if at is not None:
            self._recent.move_to(at)
        if not isinstance(last, RecordedEvent):
            self._epoch = last.epoch
        return taken
