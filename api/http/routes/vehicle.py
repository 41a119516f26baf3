"""The vehicle."""

from fastapi import APIRouter

from api.http.dependencies import SupervisorDep
from api.http.route_policy import Permission, policy
from api.http.schemas.tasks import VehicleJson

router = APIRouter(prefix="/vehicle", tags=["drive"])


@router.get("")
@policy(Permission.OBSERVE)
async def get_vehicle(supervisor: SupervisorDep) -> VehicleJson:
    """Show pose, motion and last command of the vehicle."""
    driving = supervisor.core.driving
    return VehicleJson.of(driving.vehicle, driving.limits, supervisor.clock)
