"""Who wrote what is in the log of events, and nothing that would wash it clean is."""

import json
from typing import Any

import pytest
from fastapi import FastAPI
from starlette.middleware import Middleware
from starlette.types import Receive, Scope, Send

from api.http.access import Access
from api.http.gate.audit import Audit
from api.http.gate.faults import UnexpectedErrors
from api.http.gate.policies import RoutePolicies
from api.http.route_policy import AuditClass, Permission, policy, policy_of
from api.http.route_table import each_route, methods_of
from domain.inputs import WriteRecord
from tests.support.asgi import messages_of
from tests.support.http_robot import HttpRobot, declared_policies, http_robot, http_scope
from tests.support.tables import text_table


def audits(robot: HttpRobot) -> list[dict[str, Any]]:
    events = robot.supervisor.events.oldest_first()
    return [dict(event.data) for event in events if event.kind == "audit.write"]


async def test_a_write_is_recorded_with_who_asked_and_how_it_was_answered(
    robot: HttpRobot,
) -> None:
    await robot.http.put("/emergency_stop", json={"engaged": True, "reason": "test"})

    (told,) = (await robot.get("/events?kind=audit.write"))["items"]
    assert told["actor"] == "http:127.0.0.1"
    assert told["cause"] is None
    assert told["data"] == {
        "method": "PUT",
        "path": "/emergency_stop",
        "status": 200,
        "address": "127.0.0.1:123",
    }


@text_table("""
    method | path                         | body                     | status
    POST   | /systems/actuation/mode      | {"mode": "MODERATE"}     | 202
    POST   | /systems/actuation/mode      | {"mode": "NO_SUCH_MODE"} | 422
    POST   | /systems/nobody/mode         | {"mode": "MODERATE"}     | 404
    PATCH  | /nodes/drive_base/parameters | {"max_speed": 0.2}       | 202
    DELETE | /changes/c99                 |                          | 404
    POST   | /tasks                       | {"waypoints": []}        | 422
    DELETE | /tasks/current               |                          | 204
    PUT    | /holds/operator              | {"reason": "test"}       | 200
    DELETE | /holds/error                 |                          | 409
    PATCH  | /mock/battery_level          | {"value": 0.7}           | 200
    POST   | /errors/ESTOP/acknowledge    |                          | 200
""")
async def test_every_write_that_reaches_a_route_is_recorded_also_a_refused_one(
    method: str, path: str, body: str, status: str, robot: HttpRobot
) -> None:
    answer = await robot.http.request(method, path, json=json.loads(body or "null"))

    assert answer.status_code == int(status)
    assert audits(robot) == [
        {"method": method, "path": path, "status": int(status), "address": "127.0.0.1:123"}
    ]


async def test_the_query_is_not_recorded_since_anything_may_be_in_it(robot: HttpRobot) -> None:
    await robot.http.delete("/tasks/current?token=secret")

    assert "secret" not in str(audits(robot))


@text_table("""
    method | path                                     | body
    GET    | /systems                                 |
    HEAD   | /systems                                 |
    POST   | /signals                                 | {"battery_level": 0.9}
    POST   | /signals/battery_level                   | {"value": 0.9}
    POST   | /inference                               | {}
    POST   | /model/check                             | {}
    POST   | /tasks/preview                           | {}
    POST   | /systems/actuation/mode?dry_run=true     | {"mode": "MODERATE"}
    POST   | /systems/actuation/mode?dry_run=1        | {"mode": "MODERATE"}
    PATCH  | /nodes/drive_base/parameters?dry_run=yes | {"max_speed": 0.2}
    POST   | /nowhere                                 | {}
    POST   | /emergency_stop                          | {}
""")
async def test_what_changes_nothing_and_what_only_reports_is_not(
    method: str, path: str, body: str, robot: HttpRobot
) -> None:
    await robot.http.request(method, path, json=json.loads(body or "null"))

    assert audits(robot) == []


@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("POST", "/systems/actuation/mode?dry_run=false"),
        ("POST", "/systems/actuation/mode?dry_run=true&dry_run=false"),
        ("POST", "/systems/actuation/mode?dry_run=perhaps"),
        ("PUT", "/emergency_stop?dry_run=true"),
        ("DELETE", "/tasks/current?dry_run=true"),
        ("POST", "/tasks?dry_run=true"),
    ],
)
async def test_a_query_hides_no_write(method: str, path: str, robot: HttpRobot) -> None:
    await robot.http.request(method, path, json={"mode": "MODERATE"})

    assert len(audits(robot)) == 1


def test_just_the_routes_that_take_a_dry_run_are_recorded_without_it_only(
    robot: HttpRobot,
) -> None:
    planned = {
        (path, method.upper())
        for path, operations in robot.app.openapi()["paths"].items()
        for method, operation in operations.items()
        if any(given["name"] == "dry_run" for given in operation.get("parameters", ()))
    }
    declared = {
        (route.path.replace(":path", ""), method)
        for route in each_route(robot.app.routes)
        if (found := policy_of(route.endpoint)) and found.audit is AuditClass.UNLESS_DRY_RUN
        for method in methods_of(route)
    }

    assert planned
    assert declared == planned


@pytest.mark.parametrize(
    "headers", [{"host": "evil.example"}, {"origin": "http://evil.example"}, {"authorization": "x"}]
)
async def test_who_was_turned_away_at_the_gate_did_not_write(headers: dict[str, str]) -> None:
    access = Access.with_token("correct-horse-battery")
    async with http_robot(access=access) as robot:
        answer = await robot.http.delete("/tasks/current", headers=headers)

        assert answer.status_code in (401, 403)
        assert audits(robot) == []


async def test_a_fault_in_a_route_is_recorded_as_one() -> None:
    found: list[WriteRecord] = []
    app = FastAPI(middleware=[Middleware(UnexpectedErrors)])

    @app.post("/fails")
    @policy(Permission.OPERATE)
    async def fail() -> None:
        raise ValueError("inside")

    policies = RoutePolicies(app.routes[-1:])
    await messages_of(Audit(app, found.append, policies), http_scope("POST", "/fails"))

    assert [told.status for told in found] == [500]


async def test_the_record_is_there_before_the_answer_is(robot: HttpRobot) -> None:
    order = []

    async def route(scope: Scope, receive: Receive, send: Send) -> None:
        await send({"type": "http.response.start", "status": 204, "headers": []})
        order.append("answered")

    def record(given: WriteRecord) -> None:
        order.append(f"recorded {given.status}")

    await messages_of(
        Audit(route, record, declared_policies()), http_scope("DELETE", "/tasks/current")
    )

    assert order == ["recorded 204", "answered"]


async def test_an_address_is_written_as_in_an_url_and_a_path_is_cut() -> None:
    found: list[WriteRecord] = []

    async def route(scope: Scope, receive: Receive, send: Send) -> None:
        await send({"type": "http.response.start", "status": 200, "headers": []})

    for client in (("fd00::1", 50_000), None):
        scope = {**http_scope("PUT", "/holds/" + "x" * 1_000), "client": client}
        await messages_of(Audit(route, found.append, declared_policies()), scope)

    assert [given.address for given in found] == ["[fd00::1]:50000", "unknown"]
    assert [given.actor.label for given in found] == ["http:fd00::1", "http:unknown"]
    assert {len(given.path) for given in found} == {200}


async def test_a_simulation_records_no_writes_since_nobody_wrote(robot: HttpRobot) -> None:
    hold = {"method": "PUT", "path": "/holds/operator", "body": {"reason": "test"}}
    scenario = {"until_s": 1, "steps": [{"t_s": 0, "request": hold}]}

    answer = await robot.http.post("/simulations", json=scenario)

    kinds = {event["kind"] for event in answer.json()["events"]}
    assert "hold.set" in kinds
    assert "audit.write" not in kinds
    assert audits(robot) == []
