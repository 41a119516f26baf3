"""A field of a query that the route of a write does not know is refused, and not ignored."""

from typing import Annotated, Any

import httpx
import pytest
from fastapi import FastAPI, Query

from api.http.gate.query import QueryGate, query_fields
from api.http.route_table import each_route, methods_of
from tests.support.http_robot import HttpRobot
from tests.support.manual_clock import ManualClock
from tests.support.tables import text_table

MODE = {"mode": "MODERATE"}


async def test_a_misspelt_dry_run_moves_nothing_and_is_told_by_its_name(robot: HttpRobot) -> None:
    answer = await robot.http.post("/systems/actuation/mode?dry-run=true", json=MODE)

    assert answer.status_code == 422
    problem = answer.json()
    assert answer.headers["content-type"] == "application/problem+json"
    assert problem["code"] == "INVALID_QUERY"
    assert problem["instance"] == "/systems/actuation/mode"
    assert problem["detail"] == "query dry-run: there is no such field"
    assert problem["hint"] == "known: wait_for_s, wait, dry_run; did you mean dry_run?"
    assert problem["errors"] == [
        {
            "pointer": "",
            "code": "EXTRA_FORBIDDEN",
            "message": "query dry-run: there is no such field",
        }
    ]
    assert (await robot.get("/changes"))["items"] == []
    assert robot.sent == []


@text_table("""
    method | path                                     | told
    POST   | /systems/actuation/mode?wait=1&wait=1    | wait: is there 2 times
    POST   | /systems/actuation/mode?DRY_RUN=true     | DRY_RUN: there is no such field
    POST   | /nodes/drive_base/state?dryrun           | dryrun: there is no such field
    PATCH  | /nodes/drive_base/parameters?dry%20run=1 | dry run: there is no such field
    POST   | /tasks?speed=1                           | speed: there is no such field
    POST   | /tasks/preview?speed=1                   | speed: there is no such field
    DELETE | /holds/operator?volatil=true             | volatil: there is no such field
    DELETE | /changes/c1?a=1&b=2&a=3                  | a: there is no such field (and 1 more)
    POST   | /nodes/drive_base/checkpoints/sense?=1   | : there is no such field
    POST   | /simulations?live=true                   | live: there is no such field
""")
async def test_in_each_write_a_field_is_known_and_there_once(
    method: str, path: str, told: str, robot: HttpRobot
) -> None:
    answer = await robot.http.request(method, path, json=MODE)

    assert (answer.status_code, answer.json()["code"]) == (422, "INVALID_QUERY")
    assert answer.json()["detail"] == f"query {told}"


async def test_where_no_field_is_known_the_hint_says_so(robot: HttpRobot) -> None:
    answer = await robot.http.delete("/changes/c1?dry_run=true")

    assert answer.json()["hint"] == "this request takes no query"


async def test_a_known_field_is_taken_also_where_it_is_empty_or_coded(robot: HttpRobot) -> None:
    path = "/systems/actuation/mode?dry%5Frun=true&wait=1&"
    assert (await robot.http.post(path, json=MODE)).status_code == 200
    answer = await robot.http.post("/systems/actuation/mode?dry_run=", json=MODE)
    assert answer.json()["errors"][0]["code"] != "EXTRA_FORBIDDEN"


@pytest.mark.parametrize(
    "path", ["/systems?x=1", "/changes?limit=1&limit=2", "/nodes/drive_base/errors?actve=true"]
)
async def test_what_reads_is_answered_as_before(path: str, robot: HttpRobot) -> None:
    assert (await robot.http.get(path)).status_code == 200


@pytest.mark.parametrize(
    ("method", "path", "body"),
    [
        ("PUT", "/emergency_stop?dry-run=true", {"engaged": True}),
        ("POST", "/signals/estop?source=a&source=b", {"value": True}),
        ("POST", "/signals?source=button", {"estop": True}),
        ("PUT", "/holds/operator?volatile=true", {"reason": "test"}),
        ("PATCH", "/mock/estop?x", {"value": True}),
        ("DELETE", "/tasks/current?dry_run=true", None),
    ],
)
async def test_what_stops_the_robot_is_not_refused_for_its_query(
    method: str, path: str, body: object, robot: HttpRobot
) -> None:
    answer = await robot.http.request(method, path, json=body)

    assert answer.is_success, answer.text


async def test_a_stop_is_told_which_field_of_its_query_was_ignored(robot: HttpRobot) -> None:
    answer = await robot.http.put("/emergency_stop?dry_run=true", json={"engaged": True})

    assert answer.json()["engaged"]
    assert [fault["message"] for fault in answer.json()["ignored"]] == [
        "query dry_run: there is no such field"
    ]


async def test_a_release_that_was_only_to_be_planned_releases_nothing(robot: HttpRobot) -> None:
    await robot.http.put("/emergency_stop", json={"engaged": True})

    answer = await robot.http.put("/emergency_stop?dry_run=true", json={"engaged": False})

    assert (answer.status_code, answer.json()["code"]) == (422, "INVALID_QUERY")
    assert (await robot.get("/emergency_stop"))["engaged"]


@pytest.mark.parametrize(
    ("method", "path", "body"),
    [
        ("POST", "/signals/estop?source=a", {"value": False}),
        ("POST", "/signals/battery?x=1", {"value": 80}),
        ("PATCH", "/mock/estop?x", {"value": False}),
    ],
)
async def test_a_reading_that_stops_nothing_is_refused_for_its_query(
    method: str, path: str, body: object, robot: HttpRobot
) -> None:
    answer = await robot.http.request(method, path, json=body)

    assert (answer.status_code, answer.json()["code"]) == (422, "INVALID_QUERY")


@pytest.mark.parametrize(
    ("method", "path", "status"),
    [
        ("POST", "/nowhere?x=1", 404),
        ("PUT", "/systems?x=1", 405),
        ("POST", "/signals/battery/history?x=1", 405),
    ],
)
async def test_what_is_no_write_is_told_first(
    method: str, path: str, status: int, robot: HttpRobot
) -> None:
    assert (await robot.http.request(method, path)).status_code == status


async def test_a_list_may_be_there_as_often_as_it_has_items() -> None:
    app = FastAPI()
    app.add_middleware(QueryGate, clock=ManualClock())

    @app.post("/things")
    async def post(
        some: Annotated[list[str] | None, Query()] = None,
        all_: Annotated[list[int], Query(alias="all")] = [],  # noqa: B006
        one: str = "",
    ) -> list[Any]:
        return [some, all_, one]

    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://robot") as to:
        answer = await to.post("/things?some=a&some=b&all=1&all=2&one=c")
        refused = await to.post("/things?one=c&one=d")

    assert answer.json() == [["a", "b"], [1, 2], "c"]
    assert refused.status_code == 422


def test_the_fields_are_those_of_the_description(robot: HttpRobot) -> None:
    described = {
        (method.upper(), path): [
            given["name"] for given in operation.get("parameters", ()) if given["in"] == "query"
        ]
        for path, operations in robot.app.openapi()["paths"].items()
        for method, operation in operations.items()
    }
    found = {
        (method, route.path_format): list(query_fields(route))
        for route in each_route(robot.app.routes)
        for method in methods_of(route)
        if (method, route.path_format) in described
    }

    assert {key: sorted(names) for key, names in found.items()} == {
        key: sorted(names) for key, names in described.items()
    }
