"""Lets nothing through that would change a robot: this one is a recording."""

from starlette.types import ASGIApp, Receive, Scope, Send

from api.http.gate.policies import RoutePolicies
from api.http.gate.refusals import refuse
from api.http.problems import problem_of
from service.clock import Clock
from service.replayed_robot import RecordingError


class RecordingGate:
    """Answers 409 to each request that may change something, whatever is in it."""

    def __init__(self, app: ASGIApp, policies: RoutePolicies, clock: Clock) -> None:
        """Guard `app`.

        Args:
            app: What is behind the gate.
            policies: Which routes may change something.
            clock: For the problem document.
        """
        self._app = app
        self._policies = policies
        self._clock = clock

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what only reads."""
        declared = self._policies.of(scope) if scope["type"] == "http" else None
        if declared is not None and declared.permission.writes:
            problem = problem_of(RecordingError(), self._clock, scope["path"])
            await refuse(problem, scope, receive, send)
        else:
            await self._app(scope, receive, send)
