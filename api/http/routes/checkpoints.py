"""Checkpoints that the programs of nodes pass."""

from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Path, Response

from api.http.dependencies import ActorDep, PartDep, SupervisorDep
from api.http.route_policy import Permission, policy
from domain.inputs import CheckpointReport

router = APIRouter(prefix="/nodes", tags=["nodes"])

CheckpointPath = Annotated[
    str, Path(description="One of those under `checkpoints` of the node in the robot file")
]


@router.post(
    "/{part:path}/checkpoints/{checkpoint}",
    status_code=HTTPStatus.NO_CONTENT,
    response_class=Response,
)
@policy(Permission.REPORT)
async def report_checkpoint(
    part: PartDep, checkpoint: CheckpointPath, supervisor: SupervisorDep, actor: ActorDep
) -> None:
    """Report that the program of a node passes a checkpoint; that counts on arrival.

    While the node is active, reports that come too seldom, too often, too late or in the wrong
    order raise an error of the node. Like readings, they are neither limited nor recorded unless
    something follows from them.
    """
    supervisor.submit(CheckpointReport(part, checkpoint, actor))
