"""Keeps what must not be forgotten: notes each step of the core, and answers for requests.

What starts or loosens something is carried out only once its announcement is on disk, which shows
that storage works. What makes the robot safer is carried out at once. Either is answered when
its outcome is on disk, or when that takes too long.
"""

import logging
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from domain.errors import StorageDegradedError
from domain.inputs import Input, StorageStatus
from domain.outbox import Outputs
from domain.timebase import Duration, Instant, seconds
from service.clock import Clock
from service.forked_call import ForkedCallError, forked_call
from service.storage.journal import Journal, Plain
from service.storage.trends.trends import Trends

log = logging.getLogger(__name__)

BARRIER_S = 2.0
"""A request that starts something is rejected if the disk takes longer."""
OUTCOME_S = 2.0
"""Its answer waits so long for its outcome to be on disk."""
SAFER_S = 0.05
"""The answer to what makes the robot safer waits no longer: so it is there within 0.1 s, also while
the loop is busy with 10,000 nodes."""

LOOK_EVERY = seconds(0.25)
WORKS_FOR = seconds(3.0)
"""Storage that failed works again if it has worked for so long."""
RETRY_CHECKPOINT = seconds(60.0)


@dataclass(frozen=True, slots=True)
class Taken:
    """A request that the core accepted."""

    outputs: Outputs
    is_durable: bool
    """Whether its outcome is on disk."""


@dataclass(frozen=True, slots=True)
class Memory:
    """Something besides the core that survives a restart, such as where a simulated robot is."""

    name: str
    value: Callable[[], Plain]
    revision: Callable[[], object]
    """Differs when the value does; cheap."""
    every: Duration
    """Kept at most so often; so much may be lost. 0: with the step that tells of it."""


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """How the state of the core is written down, so that a replay can begin there."""

    state: Callable[[], bytes]
    """Returns it as it is now; of a large robot in a fork, since that takes most of a second."""
    is_large: bool


@dataclass(frozen=True, slots=True)
class Stores:
    """Where the service keeps what survives it."""

    journal: Journal | None = None
    """What happens, and what must not be forgotten; None: nothing is kept."""
    trends: Trends | None = None
    """The history of the signals; None: there is none."""
    memories: Sequence[Memory] = ()
    """What the journal keeps besides the core."""

    async def close(self) -> None:
        """Write down what is noted, and release the folder."""
        if self.trends is not None:
            await self.trends.close()
        if self.journal is not None:
            await self.journal.close()


NO_STORES = Stores()
"""Nothing survives."""


class Keeper:
    """Passes requests on, each with the order of disk and robot that it needs."""

    def __init__(
        self,
        journal: Journal,
        submit: Callable[[Input], Outputs],
        clock: Clock,
        memories: Sequence[Memory] = (),
        checkpoint: Checkpoint | None = None,
    ) -> None:
        """Prepare.

        Args:
            journal: Keeps what follows from each input.
            submit: Passes an input to the core, and notes the step in the journal.
            clock: Of the service.
            memories: What else the service keeps.
            checkpoint: How the state of the core is written down; None: it is not.
        """
        self._journal = journal
        self._submit = submit
        self._clock = clock
        self._memories = memories
        self._checkpoint = checkpoint
        self._remembered: dict[str, tuple[Instant, object]] = {}
        """By memory, when it was kept last, and its revision then."""
        self._fault: str | None = None
        """As the core was told."""
        self._failed_at: Instant = 0
        self._requests = 0

    async def run(self) -> None:
        """Keep what changes without a request, and tell how storage is, until cancelled."""
        while True:
            await self._clock.sleep_until(self._clock.now() + LOOK_EVERY)
            self.look()
            if self._checkpoint is not None and self._journal.wants_checkpoint:
                await self._write_checkpoint(self._checkpoint)

    def look(self) -> None:
        """Keep memories that changed, and tell the core if storage fails or works again."""
        self._keep(self._memories, self._clock.now())
        now, fault = self._clock.now(), self._journal.fault
        if fault is not None:
            self._failed_at = now
        # A disk that has just become full takes some writes and not others.
        elif self._fault is None or now - self._failed_at < WORKS_FOR:
            return
        if (fault is None) is not (self._fault is None):
            self._fault = fault
            self._submit(StorageStatus(available=fault is None, reason=fault or ""))

    async def _write_checkpoint(self, checkpoint: Checkpoint) -> None:
        """Write down the state of the core as it is now."""
        step, at = self._journal.last_step, self._clock.now()
        if not checkpoint.is_large:
            self._journal.checkpoint(step, at, checkpoint.state())
            return
        try:
            self._journal.checkpoint(step, at, await forked_call(checkpoint.state))
        except (OSError, ForkedCallError) as error:
            log.warning("no checkpoint was written, it is tried again: %s", error)
            await self._clock.sleep_until(at + RETRY_CHECKPOINT)

    def keep_with_step(self, now: Instant) -> None:
        """Keep those memories that are kept with the step that tells of a change."""
        self._keep((memory for memory in self._memories if not memory.every), now)

    def _keep(self, memories: Iterable[Memory], now: Instant) -> None:
        for memory in memories:
            kept_at, kept = self._remembered.get(memory.name, (now - memory.every, None))
            if now - kept_at < memory.every or (revision := memory.revision()) == kept:
                continue
            self._remembered[memory.name] = now, revision
            self._journal.keep(memory.name, memory.value())

    async def request(self, given: Input, *, first: bool) -> Taken:
        """Pass a request to the core, and return when its outcome is on disk or takes too long.

        Args:
            given: A request.
            first: Announce it first: it may start or loosen something.

        Raises:
            StorageDegradedError: It cannot be announced; nothing was done.
            PilothouseError: The core rejects it; nothing was done.
        """
        if first:
            await self._announce(given)
        outputs = self._submit(given)
        return Taken(outputs, await self._is_stored(OUTCOME_S if first else SAFER_S))

    async def _announce(self, given: Input) -> None:
        self._requests += 1
        what: Plain = [self._requests, type(given).__name__]
        if not await self._journal.announce(what, BARRIER_S):
            raise StorageDegradedError(f"the disk takes more than {BARRIER_S:g} s")

    async def _is_stored(self, patience_s: float) -> bool:
        try:
            return await self._journal.commit(patience_s) and self._journal.is_durable
        except StorageDegradedError:
            return False
