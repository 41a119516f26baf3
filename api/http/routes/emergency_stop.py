"""The emergency stop: a latch that only an operator releases, never a reading."""

from fastapi import APIRouter

from api.http.dependencies import ActorDep, SupervisorDep
from api.http.request_body import JsonRoute
from api.http.route_policy import Permission, policy
from api.http.schemas.health import EmergencyStopBody, EmergencyStopJson
from domain.inputs import EmergencyStopRequest

router = APIRouter(prefix="/emergency_stop", tags=["health"], route_class=JsonRoute)


@router.get("")
@policy(Permission.OBSERVE)
async def get_emergency_stop(supervisor: SupervisorDep) -> EmergencyStopJson:
    """Show whether the emergency stop is engaged, by whom and why."""
    return EmergencyStopJson.of(supervisor.core.emergency_stop(), supervisor.clock)


@router.put("")
@policy(Permission.STOP)
async def set_emergency_stop(
    body: EmergencyStopBody, supervisor: SupervisorDep, actor: ActorDep
) -> EmergencyStopJson:
    """Engage or release the emergency stop; repeating a request changes nothing.

    This is a software stop. It is not safety-rated and does not replace a hardware stop. In this
    version a restart of the service releases it, since it is not stored.
    """
    supervisor.submit(EmergencyStopRequest(body.engaged, body.reason or "", actor))
    return EmergencyStopJson.of(supervisor.core.emergency_stop(), supervisor.clock)
