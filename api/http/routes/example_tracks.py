"""Built-in tracks for a simulated vehicle."""

from typing import Annotated

from fastapi import APIRouter, Path, Response
from pydantic import Field

from api.http.dependencies import SupervisorDep
from api.http.route_policy import Permission, policy
from api.http.schemas.base import Json
from domain.errors import UnknownNameError
from service.example_tracks import TRACKS, track_text
from service.supervisor import Supervisor

router = APIRouter(prefix="/examples/tracks", tags=["drive"])


class ExampleTrackJson(Json):
    """A built-in track."""

    name: str = Field(description="As in `GET /examples/tracks/{name}`")
    title: str


class ExampleTracksJson(Json):
    """The built-in tracks; none if the vehicle is real."""

    items: list[ExampleTrackJson]


@router.get("")
@policy(Permission.OBSERVE)
async def list_example_tracks(supervisor: SupervisorDep) -> ExampleTracksJson:
    """List the built-in tracks; none if the vehicle is real."""
    return ExampleTracksJson(
        items=[ExampleTrackJson(name=name, title=title) for name, title in _offered(supervisor)]
    )


@router.get(
    "/{name}",
    response_class=Response,
    responses={200: {"content": {"text/csv": {"schema": {"type": "string"}}}}},
)
@policy(Permission.OBSERVE)
async def get_example_track(
    name: Annotated[str, Path(description="As in `GET /examples/tracks`")],
    supervisor: SupervisorDep,
) -> Response:
    """Return a track as CSV, as `POST /tasks` takes it."""
    offered = [known for known, _ in _offered(supervisor)]
    if name not in offered:
        raise UnknownNameError("track", name, offered)
    return Response(track_text(name), media_type="text/csv")


def _offered(supervisor: Supervisor) -> list[tuple[str, str]]:
    return list(TRACKS.items()) if "vehicle" in supervisor.simulated else []
