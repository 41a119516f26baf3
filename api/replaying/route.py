"""`/replay`: where a recording is, and how fast it goes on."""

from typing import Annotated

from fastapi import APIRouter, Depends, Request
from pydantic import Field

from api.http.route_policy import Permission, policy
from api.http.schemas.base import Body, rfc3339
from api.http.schemas.sent_values import SentMoment
from api.http.schemas.stream import ReplayJson
from api.replaying.player import MAX_SPEED, MIN_SPEED, Player
from service.clock import since_epoch, to_datetime

router = APIRouter(tags=["service"])


class ReplayBody(Body):
    """How a recording is to go on; what is left out stays as it is."""

    speed: float | None = Field(default=None, ge=MIN_SPEED, le=MAX_SPEED)
    paused: bool | None = None
    # A text, in JSON.
    at: SentMoment | None = Field(
        default=None, strict=False, description="The moment to go on from"
    )


async def _player(request: Request) -> Player:
    found: Player = request.app.state.player
    return found


PlayerDep = Annotated[Player, Depends(_player)]


@router.get("/replay")
@policy(Permission.OBSERVE)
async def get_replay(player: PlayerDep) -> ReplayJson:
    """Show where the recording is, and how fast it goes on."""
    return shown(player)


# It changes nothing of a robot.
@router.put("/replay")
@policy(Permission.OBSERVE)
async def put_replay(body: ReplayBody, player: PlayerDep) -> ReplayJson:
    """Let it go on faster or slower, stand, or go on from another moment.

    Clients of the stream are disconnected if the moment changes: they come again for what was
    known then.
    """
    if body.speed is not None:
        player.speed = body.speed
    if body.paused is not None:
        player.is_paused = body.paused
    if body.at is not None:
        await player.seek(since_epoch(body.at))
    return shown(player)


def shown(player: Player) -> ReplayJson:
    """Return how a recording is shown."""
    recording = player.recording
    begin, end, at = map(to_datetime, (recording.begin, recording.end, player.wall))
    return ReplayJson(
        robot=recording.robot,
        from_at=rfc3339(begin),
        to_at=rfc3339(end),
        at=rfc3339(at),
        speed=player.speed,
        paused=player.is_paused,
        fault=player.fault,
    )
