"""The emergency stop: a latch that only an operator releases, never a reading."""

from fastapi import APIRouter

from api.http.dependencies import ActorDep, SupervisorDep
from api.http.kept_requests import KeptDep
from api.http.route_policy import Permission, policy
from api.http.schemas.health import (
    EmergencyStopAnswerJson,
    EmergencyStopBody,
    EmergencyStopJson,
)
from api.http.stop_route import IgnoredDep, StopRoute
from domain.computers import StopId
from domain.inputs import EmergencyStopRequest

router = APIRouter(prefix="/emergency_stop", tags=["health"], route_class=StopRoute)


@router.get("")
@policy(Permission.OBSERVE)
async def get_emergency_stop(supervisor: SupervisorDep) -> EmergencyStopJson:
    """Show whether the emergency stop is engaged, by whom and why."""
    return EmergencyStopJson.of(supervisor.core.emergency_stop(), supervisor.clock)


@router.put("", response_model_exclude_unset=True)
@policy(Permission.STOP)
async def set_emergency_stop(
    body: EmergencyStopBody,
    supervisor: SupervisorDep,
    kept: KeptDep,
    actor: ActorDep,
    ignored: IgnoredDep,
) -> EmergencyStopAnswerJson:
    """Engage or release the emergency stop; repeating a request changes nothing.

    A request to engage is taken whatever else is in the body; `ignored` tells what was not.

    This is a software stop. It is not safety-rated and does not replace a hardware stop. A restart
    of the service does not release it. While storage fails it is released only with `volatile`.

    Of a robot with several computers, each has a stop of its own, and the robot is stopped while
    any is engaged. A release ends the one here, and asks the other computers to end theirs:
    `waits_for` tells who did not yet. One that cannot be heard is not asked.
    """
    stops = None if body.stops is None else tuple(map(StopId, body.stops))
    asked = EmergencyStopRequest(body.engaged, body.reason or "", actor, stops)
    await kept.submit(asked, volatile=body.volatile)
    shown = EmergencyStopJson.of(supervisor.core.emergency_stop(), supervisor.clock)
    return EmergencyStopAnswerJson(**dict(shown)).model_copy(update=ignored)
