"""The state of the robot as a whole, and its errors."""

from typing import Annotated

from fastapi import APIRouter, Path

from api.http.dependencies import ActorDep, SupervisorDep
from api.http.kept_requests import KeptDep, VolatileDep
from api.http.request_body import JsonRoute
from api.http.route_policy import Permission, policy
from api.http.schemas.health import SystemStateJson
from domain.inputs import AcknowledgeRequest
from service.supervisor import Supervisor

router = APIRouter(tags=["health"], route_class=JsonRoute)


def current_system_state(supervisor: Supervisor) -> SystemStateJson:
    """Return the current system state."""
    clock = supervisor.clock
    view = supervisor.core.system_state()
    return SystemStateJson.of(
        view, supervisor.publisher.seq, clock.now(), supervisor.simulated, clock
    )


@router.get("/system_state")
@policy(Permission.OBSERVE)
async def get_system_state(supervisor: SupervisorDep) -> SystemStateJson:
    """Show whether the robot is IDLE, RUNNING or in ERROR, and why."""
    return current_system_state(supervisor)


@router.post("/errors/{error}/acknowledge")
@policy(Permission.OPERATE)
async def acknowledge_error(
    error: Annotated[str, Path(description="One of `errors` in `GET /system_state`")],
    supervisor: SupervisorDep,
    kept: KeptDep,
    actor: ActorDep,
    volatile: VolatileDep,
) -> SystemStateJson:
    """Acknowledge an error that requires it; the error ends once its cause is gone as well."""
    await kept.submit(AcknowledgeRequest(error, actor), volatile=volatile)
    return current_system_state(supervisor)
