"""Holds: they keep the vehicle from driving its task, each with an owner and a reason."""

from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Path, Response

from api.http.dependencies import ActorDep, SupervisorDep
from api.http.kept_requests import KeptDep, VolatileQuery
from api.http.route_policy import Permission, policy
from api.http.schemas.tasks import HoldAnswerJson, HoldBody, HoldJson, HoldsJson
from api.http.stop_route import IgnoredDep, StopRoute
from domain.inputs import HoldRequest, ReleaseRequest

router = APIRouter(prefix="/holds", tags=["drive"], route_class=StopRoute)

OwnerPath = Annotated[
    str,
    Path(
        pattern=r"^(reaction:)?[a-zA-Z0-9][a-zA-Z0-9_.-]{0,63}$",
        description=(
            "Any name but `error`, `vehicle` and those of reactions (`reaction:LIMP`), which are"
            " Pilothouse's own"
        ),
    ),
]


@router.get("")
@policy(Permission.OBSERVE)
async def list_holds(supervisor: SupervisorDep) -> HoldsJson:
    """List the holds, the oldest first; a task runs only without holds."""
    clock = supervisor.clock
    holds = supervisor.core.driving.holds.values()
    return HoldsJson(items=[HoldJson.of(hold, clock) for hold in holds])


@router.put("/{owner}", response_model_exclude_unset=True)
@policy(Permission.STOP)
async def set_hold(
    owner: OwnerPath,
    supervisor: SupervisorDep,
    kept: KeptDep,
    actor: ActorDep,
    ignored: IgnoredDep,
    body: HoldBody | None = None,
) -> HoldAnswerJson:
    """Hold the task: speed 0 is commanded at once. Repeating the request only updates the reason.

    A hold stays in force until it is released, also if another task is submitted meanwhile. It is
    set whatever else is in the body; `ignored` tells what was not taken.
    """
    await kept.submit(HoldRequest(owner, body.reason if body else "", actor))
    shown = HoldJson.of(supervisor.core.driving.holds[owner], supervisor.clock)
    return HoldAnswerJson(**dict(shown)).model_copy(update=ignored)


@router.delete("/{owner}", status_code=HTTPStatus.NO_CONTENT, response_class=Response)
@policy(Permission.OPERATE)
async def release_hold(
    owner: OwnerPath, kept: KeptDep, actor: ActorDep, *, volatile: VolatileQuery = False
) -> None:
    """Release a hold; the task resumes without holds. If there is no such hold, nothing changes."""
    await kept.submit(ReleaseRequest(owner, actor), volatile=volatile)
