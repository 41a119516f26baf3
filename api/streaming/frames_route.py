"""`GET /frames`: how the robot was at a moment."""

from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Depends, Query, Request, Response

from api.http.client_presence import while_connected
from api.http.dependencies import SupervisorDep
from api.http.problems import HttpError
from api.http.route_policy import Permission, policy
from api.http.schemas.sent_values import SentMoment
from api.http.schemas.stream import StateFrame
from api.streaming.frame_jobs import WantedFrame, frame_of
from domain.errors import StorageDegradedError
from service.recorded_pieces import MomentNotRecordedError
from service.supervisor import Supervisor
from service.worker import Jobs

router = APIRouter(tags=["events"])

_WRITTEN_WITHIN_S = 2.0
"""So long an answer waits for the last steps to be on disk, from where they are read."""


async def _replayer(request: Request) -> Jobs:
    found: Jobs = request.app.state.replayer
    return found


ReplayerDep = Annotated[Jobs, Depends(_replayer)]


@router.get("/frames", response_model=StateFrame)
@policy(Permission.OBSERVE)
async def get_frame(
    request: Request,
    supervisor: SupervisorDep,
    replayer: ReplayerDep,
    at: Annotated[
        SentMoment,
        Query(description="RFC 3339 with an offset, such as `2026-05-04T12:00:00.250Z`"),
    ],
) -> Response:
    """Show how the robot was at a moment: the complete frame of the stream, with all topics.

    It is replayed from what was written down, up to the end of that millisecond; so the `at` of an
    event shows what the event led to. `simulated` is as it is now, since no record tells it.
    404: the robot did not run then, or it is not kept (any longer); the answer says what is.
    """
    folder = _folder_of(supervisor)
    replayer.require_room()
    now = supervisor.clock.wall_time(supervisor.clock.now())
    fault = await _unwritten(supervisor)
    wanted = WantedFrame(folder, at, None if fault else now, supervisor.simulated)
    try:
        content = await while_connected(request, replayer.call(frame_of, wanted))
    except MomentNotRecordedError:
        started_at = supervisor.clock.wall_time(supervisor.started_at)
        if fault is not None and started_at <= at <= now:
            raise fault from None
        raise
    return Response(content, media_type="application/json")


def _folder_of(supervisor: Supervisor) -> str:
    """Return where the record of the robot is.

    Raises:
        HttpError: It is kept in memory only, or not at all.
    """
    journal = supervisor.journal
    if journal is None or journal.status().path == _MEMORY:
        detail = "nothing is recorded: this service keeps nothing over a restart"
        hint = "start it with --data DIR"
        raise HttpError(HTTPStatus.NOT_FOUND, MomentNotRecordedError.code, detail, hint)
    return journal.status().path


_MEMORY = ":memory:"


async def _unwritten(supervisor: Supervisor) -> StorageDegradedError | None:
    """Wait until all that happened is on disk; return why it is not."""
    try:
        if supervisor.journal is None or await supervisor.journal.commit(_WRITTEN_WITHIN_S):
            return None
    except StorageDegradedError as error:
        reason = error.reason
    else:
        reason = f"the disk takes more than {_WRITTEN_WITHIN_S:g} s"
    return StorageDegradedError.while_reading("the record of that moment", reason)
