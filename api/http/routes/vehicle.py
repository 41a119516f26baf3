"""The vehicle."""

from fastapi import APIRouter

from api.http.dependencies import SupervisorDep
from api.http.route_policy import Permission, policy
from api.http.schemas.tasks import VehicleJson

router = APIRouter(prefix="/vehicle", tags=["drive"])


@router.get("")
@policy(Permission.OBSERVE)
async def get_vehicle(supervisor: SupervisorDep) -> VehicleJson:
    """Show where the vehicle is, how it moves, and what it was told last."""
    driving = supervisor.core.driving
    return VehicleJson.of(driving.vehicle, driving.limits, supervisor.clock)
