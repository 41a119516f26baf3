"""Monitors: signals that are computed from the readings of other ones."""

from fastapi import APIRouter

from api.http.dependencies import SupervisorDep
from api.http.route_policy import Permission, policy
from api.http.schemas.monitors import MonitorJson, MonitorsJson

router = APIRouter(prefix="/monitors", tags=["health"])


@router.get("")
@policy(Permission.OBSERVE)
async def list_monitors(supervisor: SupervisorDep) -> MonitorsJson:
    """List all monitors: what they compute, and which limits are in force.

    Their errors are those of signals: each monitor is in `GET /signals` as well.
    """
    return MonitorsJson(items=[MonitorJson.of_view(view) for view in supervisor.core.monitors()])
