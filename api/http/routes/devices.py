"""The computers of a robot: who is there, who owns what, and whose word counts."""

from fastapi import APIRouter

from api.http.dependencies import SupervisorDep
from api.http.route_policy import Permission, policy
from api.http.schemas.devices import DevicesJson, ListedDeviceJson, ThisDeviceJson

router = APIRouter(prefix="/devices", tags=["devices"])


@router.get("")
@policy(Permission.OBSERVE)
async def list_devices(supervisor: SupervisorDep) -> DevicesJson:
    """List the devices of the robot; a robot of one computer has none.

    On a device, `this` says whose word counts there.
    """
    supervisor.let_pass()
    clock, now = supervisor.clock, supervisor.clock.now()
    views, lead = supervisor.core.devices().values(), supervisor.core.lead()
    return DevicesJson(
        items=[
            ListedDeviceJson.at(view, supervisor.connection(view.device), clock, now)
            for view in views
        ],
        this=None if lead is None else ThisDeviceJson.of(lead, clock),
    )
