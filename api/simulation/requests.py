"""Requests of a scenario: sent to the HTTP interface itself, around the robot in virtual time."""

import asyncio
import json
from collections.abc import Callable
from http import HTTPStatus
from typing import NoReturn, TypeVarTuple

import httpx

from api.problems import MEDIA_TYPE, Problem, make_problem
from api.schemas.simulation import AskedRequest
from domain.errors import RefusedError
from service.jobs import InlineJobs
from service.supervisor import Supervisor

Given = TypeVarTuple("Given")

_HOST = "simulation"


class Requests:
    """The interface of one robot. Nothing in it waits: what takes time is answered as begun."""

    def __init__(self, supervisor: Supervisor, runner: asyncio.Runner) -> None:
        # Here and not above: the application itself leads here, by its route for simulations.
        from api.app import create_app

        self._runner = runner
        app = create_app(
            supervisor, allowed_hosts=[_HOST], worker=InlineJobs(), simulator=_Nested()
        )
        self._client = httpx.AsyncClient(transport=httpx.ASGITransport(app))

    def send(self, asked: AskedRequest) -> Problem | None:
        """Send a request; return why it was refused, or None."""
        return self._runner.run(self._send(asked))

    async def _send(self, asked: AskedRequest) -> Problem | None:
        # Not by httpx's own encoder, which raises for what is not JSON: the interface refuses that.
        body = None if asked.body is None else json.dumps(asked.body)
        headers = {} if body is None else {"Content-Type": "application/json"}
        try:
            answer = await self._client.request(
                asked.method, f"http://{_HOST}{asked.path}", content=body, headers=headers
            )
        except httpx.InvalidURL as error:
            status, detail = HTTPStatus.BAD_REQUEST, f"this is no path: {error}"
            return make_problem(status, "MALFORMED", detail, asked.path)
        if not answer.is_error:
            return None
        if answer.headers.get("content-type") != MEDIA_TYPE:
            # Such as a change that has failed already: it is answered with itself.
            status = HTTPStatus(answer.status_code)
            return make_problem(status, "FAILED", f"answered: {answer.text:.500}", asked.path)
        return Problem.model_validate_json(answer.content)


class _Nested(InlineJobs):
    """Refuses a simulation within a simulation."""

    async def call(self, function: Callable[[*Given], object], *arguments: *Given) -> NoReturn:
        """Refuse.

        Raises:
            RefusedError: Always.
        """
        raise RefusedError("a simulation begins no other one")
