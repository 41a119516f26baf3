"""Requests that nobody thought of, made from the description of the interface.

Whatever comes: no request is answered with a fault, every answer is as described, and a request
that is refused has changed nothing.
"""

import asyncio
import os
from collections.abc import Iterator
from http import HTTPStatus
from typing import Any

import httpx
import pytest
import requests
import schemathesis
from hypothesis import HealthCheck, settings
from schemathesis import Case, CheckFunction
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import positive_data_acceptance

from api.app import create_app
from tests.support.http_robot import HttpRobot, http_robot
from tests.support.live_robot import make_supervisor
from tests.support.manual_clock import settle

BASE_URL = "http://robot:8000"
LEFT_OUT: list[CheckFunction] = [
    # What is right by its form may name a part that there is not.
    positive_data_acceptance,
    # 504 is an answer: the outcome is not known. Everything else is checked in the test.
    not_a_server_error,
]
EXAMPLES = 200 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 4

schema = schemathesis.openapi.from_dict(create_app(make_supervisor(), allowed_hosts=[]).openapi())
# A body may be wrong, and too large to be looked at before that is known.
rejection = schema.config.checks.negative_data_rejection
rejection.expected_statuses = [*rejection.expected_statuses, "413"]


class Storm:
    """A robot that takes requests from a test that is no coroutine; time passes for who waits."""

    def __init__(self) -> None:
        self._runner = asyncio.Runner()
        self._context = http_robot()
        self.robot: HttpRobot = self._runner.run(self._context.__aenter__())

    def close(self) -> None:
        self._runner.run(self._context.__aexit__(None, None, None))
        self._runner.close()

    def ask(self, request: requests.PreparedRequest) -> tuple[httpx.Response, bool]:
        """Return the answer, and whether time passed before it came."""
        return self._runner.run(self._ask(request))

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
        core = supervisor.core
        return [
            supervisor.events.newest,
            core.parts(),
            core.changes(),
            core.signals(),
            core.emergency_stop(),
            supervisor.mock.view() if supervisor.mock else None,
        ]


@pytest.fixture(scope="module")
def storm() -> Iterator[Storm]:
    made = Storm()
    yield made
    made.close()


@schema.parametrize()
@settings(max_examples=EXAMPLES, suppress_health_check=list(HealthCheck))
def test_a_request_of_any_kind_is_answered_as_described(case: "Case[Any]", storm: Storm) -> None:
    before = storm.facts()
    kwargs = case.as_transport_kwargs(base_url=BASE_URL)
    prepared = requests.Request(**kwargs).prepare()

    answer, waited = storm.ask(prepared)

    assert answer.status_code < HTTPStatus.INTERNAL_SERVER_ERROR or (
        answer.status_code == HTTPStatus.GATEWAY_TIMEOUT and waited
    )
    if not answer.is_success and not waited:
        assert storm.facts() == before
    case.validate_response(answer, excluded_checks=LEFT_OUT)
