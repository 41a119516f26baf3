"""Reactions of parts: what the robot does while something is so."""

from typing import Annotated

from fastapi import APIRouter, Path, Request, Response

from api.http.dependencies import ActorDep, PartDep, PartPath, SupervisorDep, known_part
from api.http.kept_requests import KeptDep, VolatileDep
from api.http.longer_names import part_of_longer_name
from api.http.request_body import JsonRoute
from api.http.route_policy import Permission, policy
from api.http.schemas.reactions import ArmBody, ReactionJson, ReactionsJson
from domain.inputs import AcknowledgeReactionRequest, ArmRequest

router = APIRouter(tags=["reactions"])
part_router = APIRouter(route_class=JsonRoute)
"""For the reactions of one part; below `/systems` and `/nodes`."""

ReactionPath = Annotated[str, Path(description="As in `GET /reactions`")]


@router.get("/reactions")
@policy(Permission.OBSERVE)
async def list_reactions(supervisor: SupervisorDep) -> ReactionsJson:
    """List the reactions of all parts, with what calls for them, or what they wait for."""
    # What is due by now acts by now.
    supervisor.let_pass()
    views = supervisor.core.reactions().values()
    return ReactionsJson(items=[ReactionJson.of(view, supervisor.clock) for view in views])


@part_router.get("/{part:path}/reactions", response_model=ReactionsJson)
@policy(Permission.OBSERVE)
async def list_part_reactions(
    part: PartPath, supervisor: SupervisorDep, request: Request
) -> Response:
    """List the reactions of the part, with what calls for them, or what they wait for."""
    if (whole := part_of_longer_name(f"{part}/reactions", request, supervisor)) is not None:
        return whole
    name = known_part(part, request, supervisor)
    supervisor.let_pass()
    views = (view for view in supervisor.core.reactions().values() if view.part == name)
    shown = ReactionsJson(items=[ReactionJson.of(view, supervisor.clock) for view in views])
    return Response(shown.model_dump_json(), media_type="application/json")


@part_router.patch("/{part:path}/reactions/{reaction}")
@policy(Permission.OPERATE)
async def arm_reaction(
    part: PartDep,
    reaction: ReactionPath,
    body: ArmBody,
    supervisor: SupervisorDep,
    kept: KeptDep,
    actor: ActorDep,
) -> ReactionJson:
    """Let a reaction act (`active`), only tell when it would (`passive`), or neither (`disarmed`).

    It stays so over restarts of the service.
    """
    await kept.submit(ArmRequest(part, reaction, body.arm, body.reason, actor))
    return ReactionJson.of(supervisor.core.reaction_of(part, reaction), supervisor.clock)


@part_router.post("/{part:path}/reactions/{reaction}/acknowledge")
@policy(Permission.OPERATE)
async def acknowledge_reaction(
    part: PartDep,
    reaction: ReactionPath,
    supervisor: SupervisorDep,
    kept: KeptDep,
    actor: ActorDep,
    volatile: VolatileDep,
) -> ReactionJson:
    """Say that somebody has seen what a reaction did.

    One that lasts until it is acknowledged ends once its condition is no longer true as well; one
    that acted too often may act again.
    """
    request = AcknowledgeReactionRequest(part, reaction, actor)
    await kept.submit(request, volatile=volatile)
    return ReactionJson.of(supervisor.core.reaction_of(part, reaction), supervisor.clock)
