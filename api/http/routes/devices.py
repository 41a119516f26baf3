"""The computers of a robot: who is there, who owns what, and whose word counts."""

from fastapi import APIRouter

from api.http.dependencies import SupervisorDep
from api.http.route_policy import Permission, policy
from api.http.schemas.devices import DevicesJson, ListedDeviceJson, ThisDeviceJson

router = APIRouter(prefix="/devices", tags=["devices"])


@router.get("", response_model_exclude_unset=True)
@policy(Permission.OBSERVE)
async def list_devices(supervisor: SupervisorDep) -> DevicesJson:
    """List the devices of the robot; a robot of one computer has none.

    On a device, `this` says whose word counts there.
    """
    supervisor.let_pass()
    clock, now = supervisor.clock, supervisor.clock.now()
    items = [
        ListedDeviceJson.at(view, supervisor.connection(view.device), clock, now)
        for view in supervisor.core.devices().values()
    ]
    lead = supervisor.core.lead()
    if lead is None:
        return DevicesJson(items=items)
    return DevicesJson(items=items, this=ThisDeviceJson.of(lead, clock))
