"""A request finds its route among those that begin like it."""

import httpx
import pytest
from fastapi import APIRouter, FastAPI, WebSocket
from starlette.types import Message

from api.http.route_table import RouteTable, each_route, first_name, unfolded
from tests.support.asgi import websocket_scope
from tests.support.tables import text_table


def small_app() -> FastAPI:
    holds, parts, router = APIRouter(prefix="/holds"), APIRouter(), APIRouter()

    @holds.get("/{owner:path}")
    async def get(owner: str) -> str:
        return f"hold of {owner}"

    @holds.put("/{owner:path}")
    async def put(owner: str) -> str:
        return f"set by {owner}"

    @parts.get("/{part:path}/mode")
    async def mode(part: str) -> str:
        return f"mode of {part}"

    @router.get("/livez")
    async def livez() -> str:
        return "alive"

    @router.websocket("/ws")
    async def stream(socket: WebSocket) -> None:
        await socket.accept()
        await socket.close()

    router.include_router(holds)
    for kind in ("systems", "nodes"):
        router.include_router(parts, prefix=f"/{kind}")
    return FastAPI(routes=[RouteTable(router.routes)], redirect_slashes=False)


@text_table("""
    method | path           | status | answer
    GET    | /livez         | 200    | alive
    GET    | /holds/a/b     | 200    | hold of a/b
    PUT    | /holds/a       | 200    | set by a
    GET    | /nodes/x/mode  | 200    | mode of x
    GET    | /systems/x/mode| 200    | mode of x
    PUT    | /livez         | 405    | -
    DELETE | /holds/a       | 405    | -
    GET    | /holds         | 404    | -
    GET    | /hold/a        | 404    | -
    GET    | //holds/a      | 404    | -
    GET    | /              | 404    | -
""")
async def test_each_path_has_its_route(method: str, path: str, status: str, answer: str) -> None:
    transport = httpx.ASGITransport(small_app())
    async with httpx.AsyncClient(transport=transport, base_url="http://robot") as client:
        found = await client.request(method, f"http://robot{path}")

    assert found.status_code == int(status)
    assert answer == "-" or found.json() == answer


async def test_a_websocket_has_its_route() -> None:
    sent: list[Message] = []

    async def receive() -> Message:
        return {"type": "websocket.connect"}

    async def send(message: Message) -> None:
        sent.append(message)

    await small_app()(websocket_scope({}), receive, send)

    assert [message["type"] for message in sent] == ["websocket.accept", "websocket.close"]


def test_the_routes_in_a_table_are_listed_with_the_others() -> None:
    app = small_app()

    paths = {route.path for route in each_route(app.routes)}

    assert {"/livez", "/holds/{owner:path}", "/nodes/{part:path}/mode", "/openapi.json"} <= paths
    assert not any(isinstance(route, RouteTable) for route in unfolded(app.routes))


@pytest.mark.parametrize(
    ("path", "name"),
    [("/holds/a", "holds"), ("/holds", "holds"), ("/", ""), ("//holds", ""), ("holds", "")],
)
def test_the_first_name_of_a_path(path: str, name: str) -> None:
    assert first_name(path) == name
