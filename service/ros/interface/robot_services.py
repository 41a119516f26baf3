"""The services of the robot as a whole."""

from functools import partial

from domain.inputs import CancelTaskRequest
from service.ros.interface.offer import OWN_NODE, Fields, OfferedService
from service.ros.interface.shapes import EMPTY, checked
from service.supervisor import Supervisor

CANCEL_TASKS = "/cancel_tasks"


def robot_services(supervisor: Supervisor) -> tuple[OfferedService, ...]:
    """Return the services."""
    cancel = OfferedService(
        name=CANCEL_TASKS,
        type="std_srvs/srv/Empty",
        node=OWN_NODE,
        of_a_node=False,
        call=partial(_cancel_tasks, supervisor),
    )
    return (cancel,)


async def _cancel_tasks(supervisor: Supervisor, request: Fields, caller: str) -> Fields:
    """End the task, if there is one."""
    checked(EMPTY, request)
    supervisor.submit(CancelTaskRequest(caller))
    return {}
