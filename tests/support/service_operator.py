"""An operator inside the service, whose words need no network."""

from collections.abc import Awaitable

from domain.identifiers import ChangeId
from domain.inputs import ChangeRequest, Input, Readings
from domain.outbox import Outputs
from service.supervisor import Supervisor
from tests.support.manual_clock import ManualClock
from tests.support.operator_verbs import OperatorVerbs, change_of


class ServiceOperator(OperatorVerbs[Outputs, ChangeId, Awaitable[None]]):
    """Hands everything to the supervisor of a live robot, as the interfaces do."""

    source = "api"

    def __init__(self, supervisor: Supervisor, clock: ManualClock) -> None:
        self._supervisor = supervisor
        self._clock = clock

    def give(self, given: Input) -> Outputs:
        """Submit an input."""
        if isinstance(given, Readings):
            return self._supervisor.readings.submit(given.items, given.source)
        return self._supervisor.submit(given)

    def begin(self, request: ChangeRequest) -> ChangeId:
        """Ask for a change and return it."""
        return change_of(self.give(request))

    async def advance(self, duration_s: float) -> None:
        """Let the clock go on."""
        await self._clock.advance(duration_s)
