"""Answers to requests for a change: its plan, an immediate answer, or one at its end."""

from contextlib import suppress
from dataclasses import dataclass
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import Depends, Query, Request, Response
from starlette.requests import ClientDisconnect

from api.http.change_text import change_text, with_steps
from api.http.client_presence import while_connected
from api.http.kept_requests import KeptRequests
from api.http.schemas.base import seconds_or_none
from api.http.schemas.changes import ChangeJson, PlanJson, shown_request
from domain.changes.admission import part_of
from domain.identifiers import ChangeId
from domain.inputs import ChangeRequest
from domain.snapshot import ChangeStatus, ChangeView
from service.supervisor import Supervisor

MAX_WAIT_S = 60.0

_STATUS_OF_END = {
    ChangeStatus.WAITING: HTTPStatus.ACCEPTED,
    ChangeStatus.RUNNING: HTTPStatus.ACCEPTED,
    ChangeStatus.SUCCEEDED: HTTPStatus.OK,
    ChangeStatus.FAILED: HTTPStatus.CONFLICT,
    ChangeStatus.SUPERSEDED: HTTPStatus.CONFLICT,
    ChangeStatus.CANCELED: HTTPStatus.CONFLICT,
    ChangeStatus.TIMED_OUT: HTTPStatus.GATEWAY_TIMEOUT,
}

CHANGE_RESPONSES: dict[int | str, dict[str, Any]] = {
    200: {"model": ChangeJson | PlanJson, "description": "With `wait`: succeeded. The plan."},
    202: {"model": ChangeJson, "description": "The change has started; see `Location`"},
    409: {
        "model": ChangeJson,
        "description": "Rejected (a problem), or with `wait`: not succeeded",
    },
    504: {"model": ChangeJson, "description": "With `wait`: timed out, the outcome is unknown"},
}
"""For the description of routes that begin a change."""


@dataclass(frozen=True, slots=True)
class ChangeOptions:
    """The kind of answer that the client wants."""

    wait_s: float | None
    """None: at once."""
    dry_run: bool


async def _options(
    wait: Annotated[
        float | None,
        Query(ge=0, le=MAX_WAIT_S, allow_inf_nan=False, description="Seconds to wait for the end"),
    ] = None,
    dry_run: Annotated[bool, Query(description="Return the plan and change nothing")] = False,
) -> ChangeOptions:
    return ChangeOptions(wait, dry_run)


ChangeOptionsDep = Annotated[ChangeOptions, Depends(_options)]


async def answer_change(
    supervisor: Supervisor, asked: ChangeRequest, options: ChangeOptions, request: Request
) -> Response:
    """Start a change, or plan it, and answer as the client wants it.

    Args:
        supervisor: Of the robot.
        asked: The change.
        options: The kind of answer.
        request: Watched for a disconnection of the client.

    Raises:
        PilothouseError: The change is rejected; nothing was changed.
    """
    clock = supervisor.clock
    if options.dry_run:
        planned = supervisor.core.plan(asked)
        plan = PlanJson(
            part=part_of(asked),
            request=shown_request(asked),
            steps=[],
            stages=planned.stages,
            expected_s=seconds_or_none(planned.expected),
        )
        return _answer(HTTPStatus.OK, await with_steps(plan, planned.steps, clock))
    change = (await KeptRequests(request).submit(asked)).change
    if change is None:
        raise RuntimeError(f"{asked} was taken and is no change")
    view = supervisor.core.change(change)
    status = HTTPStatus.ACCEPTED
    if options.wait_s is not None:
        view = await _ended(supervisor, view.id, options.wait_s, request)
        status = _STATUS_OF_END[view.status]
    text = await change_text(view, clock)
    return _answer(status, text, {"Location": f"/changes/{view.id}"})


async def _ended(
    supervisor: Supervisor, change: ChangeId, wait_s: float, request: Request
) -> ChangeView:
    """Return a change when it has ended, the wait times out, or the client disconnects."""
    with suppress(ClientDisconnect):
        await while_connected(request, supervisor.change_ends.wait(change, wait_s))
    return supervisor.core.change(change)


def _answer(status: HTTPStatus, text: str, headers: dict[str, str] | None = None) -> Response:
    return Response(text, status, headers, "application/json")
