"""Requests of a scenario, sent to the HTTP interface of the robot in virtual time."""

import asyncio
import json
from http import HTTPStatus

from api.http.problems import MEDIA_TYPE, make_problem
from api.http.schemas.problem import Problem
from api.http.schemas.simulation import AskedRequest
from api.robot_app import create_robot_app
from service.supervisor import Supervisor
from service.worker import InlineJobs

_HOST = "simulation"


class Requests:
    """The HTTP interface of one robot; no request waits for the end of what it starts."""

    def __init__(self, supervisor: Supervisor, runner: asyncio.Runner) -> None:
        # Imported here: it takes 5 MB, and the live service loads this module and sends nothing.
        import httpx

        self._runner = runner
        app = create_robot_app(supervisor, InlineJobs())
        self._client = httpx.AsyncClient(transport=httpx.ASGITransport(app))

    def send(self, asked: AskedRequest) -> Problem | None:
        """Send a request; return why it was rejected, or None."""
        return self._runner.run(self._send(asked))

    async def _send(self, asked: AskedRequest) -> Problem | None:
        import httpx

        if asked.path.startswith("/simulations"):
            detail = "a simulation cannot start another one"
            return make_problem(HTTPStatus.CONFLICT, "REFUSED", detail, asked.path)
        # httpx raises for values that are not valid JSON; here the interface must reject them.
        body = None if asked.body is None else json.dumps(asked.body)
        headers = {} if body is None else {"Content-Type": "application/json"}
        try:
            answer = await self._client.request(
                asked.method, f"http://{_HOST}{asked.path}", content=body, headers=headers
            )
        except httpx.InvalidURL as error:
            status, detail = HTTPStatus.BAD_REQUEST, f"invalid path: {error}"
            return make_problem(status, "MALFORMED", detail, asked.path)
        if not answer.is_error:
            return None
        if answer.headers.get("content-type") != MEDIA_TYPE:
            # For example a change that has failed already, which is returned itself.
            status = HTTPStatus(answer.status_code)
            return make_problem(status, "FAILED", f"answered: {answer.text:.500}", asked.path)
        return Problem.model_validate_json(answer.content)
