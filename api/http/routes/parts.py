"""Systems and nodes: their actual and target states and modes, and requests to change them.

Both kinds have the same routes, below `/systems` and `/nodes`. A name may contain slashes.
"""

import asyncio
from functools import partial
from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from api.http.body_parsing import InvalidBodyError
from api.http.change_answers import CHANGE_RESPONSES, ChangeOptionsDep, answer_change
from api.http.dependencies import (
    ActorDep,
    PartDep,
    PartPath,
    SupervisorDep,
    known_part,
)
from api.http.error_answers import ActiveQuery, answer_errors
from api.http.list_answers import json_list
from api.http.longer_names import part_of_longer_name
from api.http.part_text import part_text
from api.http.path_methods import require_allowed
from api.http.request_body import JsonRoute
from api.http.route_policy import AuditClass, Permission, policy
from api.http.schemas.base import timestamp
from api.http.schemas.errors import ErrorsJson
from api.http.schemas.parts import (
    MAX_WAIT_FOR_S,
    EnterableModeJson,
    ModeBody,
    ModeJson,
    ModesJson,
    PartJson,
    PartsJson,
    StateJson,
    StatesJson,
    TransitionBody,
    WhyJson,
)
from domain.errors import UnknownModeError, UnknownPartError
from domain.inputs import ModeRequest, TransitionRequest
from domain.lifecycle import PRIMARY_STATES, LifecycleState, Transition
from domain.timebase import Duration, seconds

router = APIRouter(route_class=JsonRoute)

WaitForQuery = Annotated[
    float | None,
    Query(ge=0, le=MAX_WAIT_FOR_S, allow_inf_nan=False, description="As in the body"),
]


@router.get("", response_model=PartsJson)
@policy(Permission.OBSERVE)
async def list_parts(request: Request, supervisor: SupervisorDep) -> Response:
    """List all systems, or all nodes, in the order of the model file."""
    kind = "system" if request.url.path == "/systems" else "node"
    views = (view for view in supervisor.core.parts().values() if view.kind == kind)
    clock = supervisor.clock
    return await json_list(part_text(view, partial(timestamp, clock)) for view in views)


@router.get("/{part:path}/state")
@policy(Permission.OBSERVE)
async def get_state(part: PartDep, supervisor: SupervisorDep) -> StateJson:
    """Show the lifecycle state, and which transitions would be accepted now."""
    # A request would find that what is due has passed.
    supervisor.let_pass()
    core = supervisor.core
    return StateJson.of(core.part(part), core.available_transitions(part))


@router.post("/{part:path}/state", status_code=202, responses=CHANGE_RESPONSES)
@policy(Permission.OPERATE, AuditClass.UNLESS_DRY_RUN)
async def change_state(
    part: PartDep,
    body: TransitionBody,
    options: ChangeOptionsDep,
    supervisor: SupervisorDep,
    actor: ActorDep,
    request: Request,
    wait_for_s: WaitForQuery = None,
) -> Response:
    """Request a lifecycle transition of the part.

    Intermediate transitions are done as needed: activate configures first, cleanup deactivates
    first. Activating a system means its mode `__DEFAULT__`.
    """
    wait_for = _wait_for(body.wait_for_s, wait_for_s)
    asked = TransitionRequest(part, Transition(body.transition), actor, wait_for)
    return await answer_change(supervisor, asked, options, request)


@router.get("/{part:path}/states")
@policy(Permission.OBSERVE)
async def list_states(part: PartDep) -> StatesJson:
    """List the primary lifecycle states."""
    return StatesJson(items=[state for state in LifecycleState if state in PRIMARY_STATES])


@router.get("/{part:path}/mode")
@policy(Permission.OBSERVE)
async def get_mode(part: PartDep, supervisor: SupervisorDep) -> ModeJson:
    """Show the mode; a part has one only while it is active or being activated."""
    return ModeJson.of(supervisor.core.part(part))


@router.post("/{part:path}/mode", status_code=202, responses=CHANGE_RESPONSES)
@policy(Permission.OPERATE, AuditClass.UNLESS_DRY_RUN)
async def change_mode(
    part: PartDep,
    body: ModeBody,
    options: ChangeOptionsDep,
    supervisor: SupervisorDep,
    actor: ActorDep,
    request: Request,
    wait_for_s: WaitForQuery = None,
) -> Response:
    """Request a mode of the part; it is configured and activated first if needed."""
    try:
        asked = ModeRequest(part, body.mode, actor, _wait_for(body.wait_for_s, wait_for_s))
        return await answer_change(supervisor, asked, options, request)
    except UnknownModeError as error:
        raise InvalidBodyError.at("mode", error) from error


@router.get("/{part:path}/modes")
@policy(Permission.OBSERVE)
async def list_modes(part: PartDep, supervisor: SupervisorDep) -> ModesJson:
    """List the modes, and for each the blockers that keep the part from entering it now."""
    # A request would find that what is due has passed.
    supervisor.let_pass()
    items = []
    for mode in supervisor.model.modes_of(part):
        # The blockers of one mode of 10,000 nodes are enough for one turn of the event loop.
        items.append(EnterableModeJson.of(supervisor.core.mode(part, mode), supervisor.clock))
        await asyncio.sleep(0)
    return ModesJson(items=items)


@router.get("/{part:path}/why", response_model=WhyJson)
@policy(Permission.OBSERVE)
async def get_why(part: PartPath, supervisor: SupervisorDep, request: Request) -> Response:
    """Show why the part is not where it should be; no reasons: it is."""
    if (whole := part_of_longer_name(f"{part}/why", request, supervisor)) is not None:
        return whole
    name = known_part(part, request, supervisor)
    # A request would find that what is due has passed.
    supervisor.let_pass()
    core = supervisor.core
    shown = WhyJson.of(core.part(name), core.why(name), supervisor.clock)
    return Response(shown.model_dump_json(), media_type="application/json")


@router.get("/{part:path}/errors", response_model=ErrorsJson)
@policy(Permission.OBSERVE)
async def list_part_errors(
    part: PartPath, supervisor: SupervisorDep, request: Request, *, active: ActiveQuery = None
) -> Response:
    """List the errors of the part, also those that are normal."""
    if (whole := part_of_longer_name(f"{part}/errors", request, supervisor)) is not None:
        return whole
    name = known_part(part, request, supervisor)
    # What is due by now is an error by now.
    supervisor.let_pass()
    return await answer_errors(supervisor, supervisor.core.errors_of(name), active)


def _wait_for(in_body: float | None, in_query: float | None) -> Duration | None:
    """Return how long a request may wait for what its modes require; the body counts first."""
    wait_s = in_query if in_body is None else in_body
    return None if wait_s is None else seconds(wait_s)


# Last, since its path matches those of all others.
@router.get("/{part:path}")
@policy(Permission.OBSERVE)
async def get_part(part: PartPath, supervisor: SupervisorDep, request: Request) -> PartJson:
    """Show one part: its requested target, the target in force, and its actual state and mode."""
    try:
        name = known_part(part, request, supervisor)
    except UnknownPartError:
        # The path may be that of what cannot be read, such as an error or a checkpoint of a part.
        require_allowed(request)
        raise
    return PartJson.of(supervisor.core.part(name), supervisor.clock)
