"""Changes: what became of what was asked."""

from collections.abc import Iterator
from itertools import islice
from typing import Annotated

from fastapi import APIRouter, Query, Response

from api.dependencies import ActorDep, SupervisorDep
from api.long_lists import json_list
from api.schemas.changes import ChangeJson, ChangesJson
from domain.messages import CancelRequest, ChangeId

router = APIRouter(prefix="/changes", tags=["changes"])

MAX_CHANGES = 1_000
_DEFAULT_CHANGES = 100


@router.get("", response_model=ChangesJson)
async def list_changes(
    supervisor: SupervisorDep,
    limit: Annotated[int, Query(ge=1, le=MAX_CHANGES)] = _DEFAULT_CHANGES,
) -> Response:
    """List changes, the newest first."""
    clock = supervisor.clock
    views = islice(supervisor.core.changes(), limit)
    texts: Iterator[str] = (ChangeJson.of(view, clock).model_dump_json() for view in views)
    return await json_list(texts)


@router.get("/{change}")
async def get_change(change: str, supervisor: SupervisorDep) -> ChangeJson:
    """Show one change with its steps."""
    return ChangeJson.of(supervisor.core.change(change), supervisor.clock)


@router.delete("/{change}")
async def cancel_change(change: str, supervisor: SupervisorDep, actor: ActorDep) -> ChangeJson:
    """Cancel a change: no further step is begun; one in flight is not recalled.

    A change that has ended stays as it ended.
    """
    supervisor.submit(CancelRequest(ChangeId(change), actor))
    return ChangeJson.of(supervisor.core.change(change), supervisor.clock)
