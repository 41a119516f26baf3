"""The journal in a folder: its front on the event loop, which never waits for a disk.

What is noted is gathered in a batch. While one flight of batches is with the writer's thread the
next is gathered, so that all who wait share one sync.
"""

import asyncio
import logging
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Final

from pydantic_core import to_json

from domain.errors import StorageDegradedError
from domain.timebase import Instant
from service.clock import Clock, since_epoch, to_datetime
from service.storage.event_rows import event_row
from service.storage.id_blocks import IdKind
from service.storage.journal import (
    Boot,
    EventQuery,
    Found,
    LogStatus,
    Plain,
    Step,
    StorageStatus,
    StoredEvent,
)
from service.storage.records import Records
from service.storage.sqlite.backlog import Backlog
from service.storage.sqlite.batch import IDS, OWN, Flight
from service.storage.sqlite.connection import FAILURES, library_version, words
from service.storage.sqlite.folder import Report
from service.storage.sqlite.opening import Opened, StoreSettings, open_folder
from service.storage.sqlite.reading import read_events
from service.storage.sqlite.writer import Writer

BATCH_S: Final = 0.05
"""How long what nobody waits for is gathered."""
RETRY_S: Final = 1.0
SLOW_S: Final = 1.0
"""A disk that takes longer for one flight is told as degraded."""
CLOSE_PATIENCE_S: Final = 5.0
_FLUSH_S: Final = 0.5

_log = logging.getLogger(__name__)


class SqliteJournal:
    """A `Journal`; made by `open`."""

    def __init__(
        self, settings: StoreSettings, boot: Boot, records: Records, clock: Clock,
        writer: Writer, opened: Opened,
    ) -> None:
        self._settings = settings
        self._boot = boot
        self._records = records
        self._clock = clock
        self._writer = writer
        self._folder = opened.folder
        self._lock = opened.lock
        self._found = opened.found
        self._ids = opened.ids
        self._report = opened.report
        self._backlog = Backlog(settings.backlog_bytes, opened.next.batch, opened.next.step)
        self._waiters: list[asyncio.Future[None]] = []
        self._boarded: list[asyncio.Future[None]] = []
        self._timer: asyncio.Handle | None = None
        self._landing: asyncio.Task[None] | None = None
        self._took_off_at = 0.0
        self._fault: str | None = None
        self._is_closed = False
        self.wants_checkpoint = True
