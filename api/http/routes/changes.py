"""Changes: the requested ones, their steps and how they ended."""

import asyncio
from typing import Annotated

from fastapi import APIRouter, Path, Query, Response

from api.http.change_text import change_text
from api.http.dependencies import ActorDep, SupervisorDep
from api.http.kept_requests import KeptDep
from api.http.list_answers import json_list
from api.http.route_policy import Permission, policy
from api.http.schemas.changes import ChangeJson, ChangesJson
from domain.errors import UnknownPartError
from domain.identifiers import ChangeId
from domain.inputs import CancelRequest
from domain.state_and_mode import part_name
from service.supervisor import Supervisor

router = APIRouter(prefix="/changes", tags=["changes"])

MAX_CHANGES = 1_000
_DEFAULT_CHANGES = 100

ChangePath = Annotated[str, Path(description="Its id, as in `Location` of the request")]


@router.get("", response_model=ChangesJson)
@policy(Permission.OBSERVE)
async def list_changes(
    supervisor: SupervisorDep,
    limit: Annotated[
        int, Query(ge=1, le=MAX_CHANGES, description="At most so many")
    ] = _DEFAULT_CHANGES,
    part: Annotated[
        str | None, Query(description="Only changes that were asked of this system or node")
    ] = None,
) -> Response:
    """List changes, the newest first."""
    name = None if part is None else part_name(part)
    if name is not None and name not in supervisor.model:
        raise UnknownPartError("part", name, supervisor.model.parts)
    clock = supervisor.clock
    views = supervisor.core.changes(limit, name)
    texts = []
    for view in views:
        texts.append(await change_text(view, clock))
        await asyncio.sleep(0)
    return await json_list(texts)


@router.get("/{change}", response_model=ChangeJson)
@policy(Permission.OBSERVE)
async def get_change(change: ChangePath, supervisor: SupervisorDep) -> Response:
    """Show one change with its steps."""
    return await _shown(supervisor, change)


@router.delete("/{change}", response_model=ChangeJson)
@policy(Permission.OPERATE)
async def cancel_change(
    change: ChangePath, supervisor: SupervisorDep, kept: KeptDep, actor: ActorDep
) -> Response:
    """Cancel a change: no further step is started; steps in progress are not recalled.

    A change that has ended keeps its status.
    """
    await kept.submit(CancelRequest(ChangeId(change), actor))
    return await _shown(supervisor, change)


async def _shown(supervisor: Supervisor, change: str) -> Response:
    text = await change_text(supervisor.core.change(change), supervisor.clock)
    return Response(text, media_type="application/json")
