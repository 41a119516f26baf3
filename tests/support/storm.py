"""A robot that takes whatever is sent, and whoever sends it need not be a coroutine."""

import asyncio
from collections import Counter
from dataclasses import replace
from typing import Any

import httpx
import requests

from api.http.limits import USUAL_LIMITS
from tests.support.http_robot import HttpRobot, http_robot
from tests.support.manual_clock import settle

# Time passes only for who waits, so all requests of a storm come in the same second.
_NO_RATE = replace(USUAL_LIMITS, requests_per_s=1_000_000)


class Storm:
    """The example robot in virtual time, in which time passes while a request waits."""

    def __init__(self) -> None:
        self._runner = asyncio.Runner()
        self._context = http_robot(limits=_NO_RATE)
        self.robot: HttpRobot = self._runner.run(self._context.__aenter__())
        self.answers: Counter[int] = Counter()
        """How often each HTTP status was answered."""

    def close(self) -> None:
        """End the robot."""
        self._runner.run(self._context.__aexit__(None, None, None))
        self._runner.close()

    def ask(self, request: requests.PreparedRequest) -> tuple[httpx.Response, bool]:
        """Return the answer, and whether time passed before it came."""
        answer, waited = self._runner.run(self._ask(request))
        self.answers[answer.status_code] += 1
        return answer, waited

    async def _ask(self, request: requests.PreparedRequest) -> tuple[httpx.Response, bool]:
        asked = asyncio.create_task(
            self.robot.http.request(
                str(request.method),
                str(request.url),
                headers={name: str(value) for name, value in request.headers.items()},
                content=request.body if isinstance(request.body, bytes | str) else None,
            )
        )
        await settle()
        # The worker is a process, and does not live in virtual time.
        await asyncio.wait({asked}, timeout=0.05)
        waited = not asked.done()
        while not asked.done():
            await self.robot.pass_time(1)
            await asyncio.wait({asked}, timeout=0.01)
        return await asked, waited

    def facts(self) -> list[Any]:
        """Return everything that a request can change."""
        supervisor = self.robot.supervisor
        core, mock = supervisor.core, supervisor.readings.mock
        # That somebody asked is recorded, also of who was refused.
        told = (e.id for e in supervisor.events.newest_first() if e.kind != "audit.write")
        return [
            next(told, 0),
            core.parts(),
            core.changes(),
            core.signals(),
            core.emergency_stop(),
            dict(core.driving.holds),
            core.driving.current_task,
            mock.view() if mock else None,
        ]

    def summary(self) -> str:
        """Return how many requests were answered, and how."""
        by_class = Counter[str]()
        for status, count in self.answers.items():
            by_class[f"{status // 100}xx"] += count
        kinds = ", ".join(f"{count:,} {kind}" for kind, count in sorted(by_class.items()))
        waited = self.answers[504]
        return (
            f"{self.answers.total():,} requests: {kinds} (of them 504, not known in time: {waited})"
        )
