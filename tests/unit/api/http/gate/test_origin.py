"""What a page of another site cannot make a browser do to the robot."""

from typing import NamedTuple

import pytest

from api.http.gate.origin import OriginGate
from api.http.gate.origins import is_same_origin
from api.http.gate.refusals import Refusals
from tests.support.asgi import answer_200, messages_of, status_of, websocket_scope
from tests.support.http_robot import HttpRobot, http_scope
from tests.support.manual_clock import ManualClock
from tests.support.tables import table

PRESS = '{"engaged": true}'
JSON = {"content-type": "application/json"}


def gate_for(allowed_hosts: list[str]) -> OriginGate:
    return OriginGate(answer_200, allowed_hosts, Refusals(ManualClock()))


# --- the name by which it is asked --------------------------------------------------------------


@pytest.mark.parametrize(
    "host",
    ["robot", "ROBOT:8000", "robot.", "localhost:1", "127.0.0.1", "127.0.0.1:8000", "[::1]:8000"],
)
async def test_the_service_answers_to_its_own_names(host: str, robot: HttpRobot) -> None:
    answer = await robot.http.get("/livez", headers={"host": host})

    assert answer.status_code == 200


@pytest.mark.parametrize(
    "host",
    ["evil.example", "robot.evil.example", "evil.example:8000", "a@robot", "robot/x", "", "[::2]"],
)
async def test_the_service_does_not_answer_to_another_name(host: str, robot: HttpRobot) -> None:
    answer = await robot.http.get("/livez", headers={"host": host})

    assert (answer.status_code, answer.json()["code"]) == (403, "HOST_NOT_ALLOWED")
    assert "--allowed-host" in answer.json()["hint"]


async def test_two_names_at_once_are_none(robot: HttpRobot) -> None:
    headers = [("host", "robot"), ("host", "evil.example")]

    assert (await robot.http.get("/livez", headers=headers)).status_code == 403


async def test_an_address_of_ipv6_is_allowed_with_or_without_brackets() -> None:
    gate = gate_for(["fd00::1", "[fd00::2]"])

    for host in ("[fd00::1]:8000", "[fd00::2]"):
        assert await status_of(gate, http_scope("GET", "/", host=host)) == 200


async def test_the_address_that_a_request_came_to_is_ours_and_another_is_not() -> None:
    """As of a service that listens on all addresses of the robot."""
    gate = gate_for(["0.0.0.0"])
    scope = {"server": ("192.168.7.2", 8000)}

    for host, status in (("192.168.7.2:8000", 200), ("192.168.7.3:8000", 403)):
        request = {**http_scope("GET", "/", host=host), **scope}
        assert await status_of(gate, request) == status


# --- who writes ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "http://robot", "https://robot:8000", "http://robot:8001", "null", ""],
)
async def test_a_foreign_page_cannot_write(origin: str, robot: HttpRobot) -> None:
    headers = {**JSON, "origin": origin.replace("https://robot:8000", "https://robot:8443")}

    answer = await robot.http.put("/emergency_stop", content=PRESS, headers=headers)

    assert (answer.status_code, answer.json()["code"]) == (403, "FOREIGN_ORIGIN")
    assert (await robot.get("/emergency_stop"))["engaged"] is False


async def test_its_own_page_can_write(robot: HttpRobot) -> None:
    headers = {**JSON, "origin": "http://robot:8000"}

    answer = await robot.http.put("/emergency_stop", content=PRESS, headers=headers)

    assert answer.status_code == 200


async def test_a_foreign_page_may_ask_but_is_not_let_read(robot: HttpRobot) -> None:
    answer = await robot.http.get("/systems", headers={"origin": "http://evil.example"})

    assert answer.status_code == 200
    assert "access-control-allow-origin" not in answer.headers


class Asked(NamedTuple):
    """A page and the host that it asks, as both stand in the headers of a request."""

    origin: str
    host: str


@table(
    {
        "without ports": Asked("http://robot", "robot"),
        "the port of http in the host": Asked("http://robot", "robot:80"),
        "the port of http in the origin": Asked("http://robot:80", "robot"),
        "https": Asked("https://robot", "robot"),
        "the port of https in the host": Asked("https://robot", "robot:443"),
        "capital letters": Asked("http://ROBOT:8000", "robot:8000"),
        "an address of IPv6": Asked("http://[::1]:8000", "[::1]:8000"),
    }
)
def test_an_origin_is_ours_if_name_and_port_are(row: Asked) -> None:
    assert is_same_origin(row.origin, row.host) is True


@table(
    {
        "another port": Asked("http://robot:8000", "robot:8001"),
        "a name that begins like ours": Asked("http://robot.evil.example", "robot"),
        "another name of the same host": Asked("http://localhost:8000", "127.0.0.1:8000"),
        "a file": Asked("file://robot", "robot"),
        "a page that hides its origin": Asked("null", "robot"),
        "nothing": Asked("", "robot"),
        "a port that is no number": Asked("http://robot:x", "robot"),
        "an address without its end": Asked("http://[robot", "robot"),
    }
)
def test_any_other_origin_is_foreign(row: Asked) -> None:
    assert is_same_origin(row.origin, row.host) is False


# --- what a page sends --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("content_type", "status"),
    [
        ("application/json", 200),
        ("application/json; charset=utf-8", 200),
        ("text/plain", 415),
        ("application/x-www-form-urlencoded", 415),
        ("multipart/form-data", 415),
        ("", 415),
    ],
)
async def test_a_page_says_that_it_sends_json_and_a_form_cannot(
    content_type: str, status: int, robot: HttpRobot
) -> None:
    headers = {"origin": "http://robot:8000", "content-type": content_type}

    answer = await robot.http.put("/emergency_stop", content=PRESS, headers=headers)

    assert answer.status_code == status
    assert (await robot.get("/emergency_stop"))["engaged"] is (status == 200)


async def test_a_page_need_not_name_the_type_of_nothing(robot: HttpRobot) -> None:
    headers = {"origin": "http://robot:8000"}

    answer = await robot.http.post("/errors/ESTOP/acknowledge", headers=headers)

    assert answer.status_code == 200


# --- WebSocket ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "headers",
    [
        {"host": "evil.example"},
        {"host": "robot:8000", "origin": "http://evil.example"},
        {"host": "robot:8000", "origin": "null"},
    ],
)
async def test_a_websocket_is_guarded_alike(headers: dict[str, str]) -> None:
    # Closed before it was accepted, which the server answers with 403.
    sent = await messages_of(gate_for(["robot"]), websocket_scope(headers))

    assert [message["type"] for message in sent] == ["websocket.close"]


@pytest.mark.parametrize(
    "headers", [{"host": "robot:8000"}, {"host": "robot:8000", "origin": "http://robot:8000"}]
)
async def test_a_websocket_of_our_own_page_or_of_no_page_gets_through(
    headers: dict[str, str],
) -> None:
    sent = await messages_of(gate_for(["robot"]), websocket_scope(headers))

    assert sent[0]["status"] == 200


async def test_who_is_turned_away_is_counted(robot: HttpRobot) -> None:
    await robot.http.get("/livez", headers={"host": "evil.example"})

    assert robot.app.state.refusals.counts == {403: 1}
