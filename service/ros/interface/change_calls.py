"""Requests for a change as ROS asks them: the answer is whether it was done, and only that."""

import logging

from domain.errors import PilothouseError
from domain.inputs import ModeRequest, TransitionRequest
from domain.snapshot import ChangeStatus
from service.supervisor import Supervisor

log = logging.getLogger(__name__)

MAX_WAIT_S = 60.0
"""For the end of a change. One that runs on is no success, and goes on."""


async def carry_out(supervisor: Supervisor, request: ModeRequest | TransitionRequest) -> bool:
    """Begin a change, wait for its end, and tell whether every node is where it should be.

    The answer has no room for a reason, and so the reason is logged.
    """
    wanted = request.mode if isinstance(request, ModeRequest) else str(request.transition)
    what = f"{wanted!r:.100} of {request.part}, asked by {request.actor}"
    try:
        change = supervisor.submit(request).change
        if change is None:
            raise RuntimeError(f"{request} was taken and is no change")
        view = await supervisor.change_ends.wait(change, MAX_WAIT_S)
    except PilothouseError as error:
        log.info("refused %s: %.500s", what, error)
        return False
    if view.status is not ChangeStatus.SUCCEEDED:
        log.info("%s: change %s %s: %.500s", what, view.id, view.status, view.reason or "")
    return view.status is ChangeStatus.SUCCEEDED
