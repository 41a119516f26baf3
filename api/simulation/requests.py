"""Requests of a scenario: sent to the HTTP interface itself, around the robot in virtual time."""

import asyncio
from collections.abc import Callable
from typing import NoReturn, TypeVarTuple

import httpx

from api.problems import Problem
from api.schemas.simulation import AskedRequest
from domain.errors import RefusedError
from service.jobs import InlineJobs
from service.supervisor import Supervisor

Given = TypeVarTuple("Given")


class Requests:
    """The interface of one robot. Nothing in it waits: what takes time is answered as begun."""

    def __init__(self, supervisor: Supervisor, runner: asyncio.Runner) -> None:
        # Here and not above: the application itself leads here, by its route for simulations.
        from api.app import create_app

        self._runner = runner
        app = create_app(
            supervisor, allowed_hosts=["simulation"], worker=InlineJobs(), simulator=_Nested()
        )
        self._client = httpx.AsyncClient(
            transport=httpx.ASGITransport(app), base_url="http://simulation"
        )

    def send(self, asked: AskedRequest) -> Problem | None:
        """Send a request; return why it was refused, or None."""
        return self._runner.run(self._send(asked))

    async def _send(self, asked: AskedRequest) -> Problem | None:
        answer = await self._client.request(asked.method, asked.path, json=asked.body)
        if not answer.is_error:
            return None
        return Problem.model_validate_json(answer.content)


class _Nested(InlineJobs):
    """Refuses a simulation within a simulation."""

    async def call(self, function: Callable[[*Given], object], *arguments: *Given) -> NoReturn:
        """Refuse.

        Raises:
            RefusedError: Always.
        """
        raise RefusedError("a simulation begins no other one")
