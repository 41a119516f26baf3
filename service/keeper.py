"""Keeps what must not be forgotten: notes each step of the core, and answers for requests.

What starts or loosens something is carried out only once storage has shown that it works: the
request is on disk then. What makes the robot safer is carried out at once. Either is answered when
its outcome is on disk, or when that takes too long.
"""

from collections.abc import Callable
from dataclasses import dataclass

from domain.errors import StorageDegradedError
from domain.inputs import (
    AcknowledgeRequest,
    CancelRequest,
    CancelTaskRequest,
    EmergencyStopRequest,
    HoldRequest,
    Input,
    ModeRequest,
    ParametersRequest,
    ReleaseRequest,
    TaskRequest,
    TransitionRequest,
)
from domain.lifecycle import Transition
from domain.outbox import Outputs
from service.storage.journal import Journal

BARRIER_S = 2.0
"""A request that starts something is rejected if the disk takes longer."""
OUTCOME_S = 2.0
"""Its answer waits so long for its outcome to be on disk."""
SAFER_S = 0.1
"""The answer to what makes the robot safer waits no longer."""

_RAISING = frozenset({Transition.CONFIGURE, Transition.ACTIVATE})
LAST_REQUEST = "last_request"
"""Under this name the journal has the last request that starts or loosens something."""


@dataclass(frozen=True, slots=True)
class Taken:
    """A request that the core accepted."""

    outputs: Outputs
    is_durable: bool
    """Whether its outcome is on disk."""


def starts_or_loosens(given: Input) -> bool:
    """Tell whether an input may start or loosen something, and so must be on disk first."""
    match given:
        case TaskRequest() | ReleaseRequest() | AcknowledgeRequest():
            return True
        case ModeRequest() | ParametersRequest():
            return True
        case TransitionRequest(transition=transition):
            return transition in _RAISING
        case EmergencyStopRequest(engaged=engaged):
            return not engaged
        case HoldRequest() | CancelRequest() | CancelTaskRequest():
            return False
    raise TypeError(f"{type(given).__name__} is no request")


class Keeper:
    """Passes requests on, each with the order of disk and robot that it needs."""

    def __init__(self, journal: Journal, submit: Callable[[Input], Outputs]) -> None:
        """Prepare.

        Args:
            journal: Keeps what follows from each input.
            submit: Passes an input to the core, and notes the step in the journal.
        """
        self._journal = journal
        self._submit = submit
        self._requests = 0

    async def request(self, given: Input, *, volatile: bool = False) -> Taken:
        """Pass a request to the core, and return when its outcome is on disk or takes too long.

        Args:
            given: A request.
            volatile: Carry it out though storage fails; a restart may forget it.

        Raises:
            StorageDegradedError: It starts or loosens something, and cannot be stored first;
                nothing was done.
            PilothouseError: The core rejects it; nothing was done.
        """
        is_first_stored = starts_or_loosens(given)
        if is_first_stored and not volatile:
            await self._store_first(given)
        outputs = self._submit(given)
        return Taken(outputs, await self._is_stored(OUTCOME_S if is_first_stored else SAFER_S))

    async def _store_first(self, given: Input) -> None:
        self._requests += 1
        self._journal.keep(LAST_REQUEST, [self._requests, type(given).__name__])
        if not await self._journal.commit(BARRIER_S):
            raise StorageDegradedError(f"the disk takes more than {BARRIER_S:g} s")

    async def _is_stored(self, patience_s: float) -> bool:
        try:
            return await self._journal.commit(patience_s)
        except StorageDegradedError:
            return False
