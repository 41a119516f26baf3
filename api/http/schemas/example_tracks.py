"""Tracks that come along, as clients see them."""

from pydantic import Field

from api.http.schemas.base import Json


class ExampleTrackJson(Json):
    """A track that comes along."""

    name: str = Field(description="As in `GET /examples/tracks/{name}`")
    title: str


class ExampleTracksJson(Json):
    """Tracks that come along; none where the vehicle is real."""

    items: list[ExampleTrackJson]
