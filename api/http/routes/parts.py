"""Systems and nodes: their actual and target states and modes, and requests to change them.

Both kinds have the same routes, below `/systems` and `/nodes`. A name may contain slashes.
"""

import asyncio
from functools import partial

from fastapi import APIRouter, Request, Response

from api.http.body_parsing import InvalidBodyError
from api.http.change_answers import CHANGE_RESPONSES, ChangeOptionsDep, answer_change
from api.http.dependencies import ActorDep, PartDep, SupervisorDep
from api.http.list_answers import json_list
from api.http.part_text import part_text
from api.http.request_body import JsonRoute
from api.http.route_policy import AuditClass, Permission, policy
from api.http.schemas.base import timestamp
from api.http.schemas.parts import (
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
from domain.errors import UnknownModeError
from domain.inputs import ModeRequest, TransitionRequest
from domain.lifecycle import PRIMARY_STATES, LifecycleState, Transition

router = APIRouter(route_class=JsonRoute)


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
) -> Response:
    """Request a lifecycle transition of the part.

    Intermediate transitions are done as needed: activate configures first, cleanup deactivates
    first. Activating a system means its mode `__DEFAULT__`.
    """
    asked = TransitionRequest(part, Transition(body.transition), actor)
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
) -> Response:
    """Request a mode of the part; it is configured and activated first if needed."""
    try:
        asked = ModeRequest(part, body.mode, actor)
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


@router.get("/{part:path}/why")
@policy(Permission.OBSERVE)
async def get_why(part: PartDep, supervisor: SupervisorDep) -> WhyJson:
    """Show why the part is not where it should be; no reasons: it is."""
    # A request would find that what is due has passed.
    supervisor.let_pass()
    core = supervisor.core
    return WhyJson.of(core.part(part), core.why(part), supervisor.clock)


# Last, since its path matches those of all others.
@router.get("/{part:path}")
@policy(Permission.OBSERVE)
async def get_part(part: PartDep, supervisor: SupervisorDep) -> PartJson:
    """Show one part: its requested target, the target in force, and its actual state and mode."""
    return PartJson.of(supervisor.core.part(part), supervisor.clock)
