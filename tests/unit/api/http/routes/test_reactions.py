"""Reactions over HTTP, as an operator sees and arms them."""

from collections.abc import AsyncIterator
from typing import Any

import pytest

from tests.support.carrier import CARRIER
from tests.support.http_robot import HttpRobot, http_robot

LIMP = "/systems/carrier/reactions/LIMP"


@pytest.fixture
async def carrier() -> AsyncIterator[HttpRobot]:
    async with http_robot(CARRIER) as robot:
        await robot.http.post("/systems/carrier/mode", json={"mode": "__DEFAULT__"})
        await robot.pass_time(1)
        yield robot


async def heat_up(robot: HttpRobot, value: float = 45.0) -> None:
    await robot.http.post("/signals/temperature", json={"value": value})
    await robot.pass_time(0.5)


async def limp(robot: HttpRobot) -> Any:  # noqa: ANN401
    listed = await robot.get("/reactions")
    return next(item for item in listed["items"] if item["reaction"] == "LIMP")


async def test_a_reaction_is_listed_with_what_it_waits_for(carrier: HttpRobot) -> None:
    shown = await limp(carrier)

    assert {key: shown[key] for key in ("part", "arm", "state", "action", "target", "left")} == {
        "part": "carrier",
        "arm": "active",
        "state": "idle",
        "action": "mode",
        "target": {"state": "active", "mode": "SLOW"},
        "left": 3,
    }
    assert (shown["when"], shown["waits_for"]) == ("temperature > 40", "temperature > 40")
    assert shown["blockers"] == []


async def test_one_that_acts_says_why_and_keeps_requests_from_leading_elsewhere(
    carrier: HttpRobot,
) -> None:
    await heat_up(carrier)

    shown = await limp(carrier)
    assert (shown["state"], shown["left"]) == ("acting", 2)
    assert shown["blockers"][0]["message"] == "temperature is 45 °C, needs <= 40 °C"
    target = (await carrier.get("/systems/carrier"))["effective_target"]
    assert (target["because"], target["reaction"], target["rule"]) == ("reaction", "LIMP", None)
    answer = await carrier.http.post("/systems/carrier/mode", json={"mode": "__DEFAULT__"})
    assert answer.status_code == 409
    (blocker,) = answer.json()["blockers"]
    assert blocker["code"] == "REACTION"
    assert blocker["causes"][0]["value"] == 45.0
    rest = await carrier.http.post("/systems/carrier/state", json={"transition": "deactivate"})
    assert rest.status_code == 202


async def test_the_reactions_of_one_part(carrier: HttpRobot) -> None:
    of_carrier = await carrier.get("/systems/carrier/reactions")
    assert [item["reaction"] for item in of_carrier["items"]] == ["LIMP", "HALT"]
    assert await carrier.get("/nodes/drive/reactions") == {"items": []}


async def test_a_reaction_is_armed_with_a_reason(carrier: HttpRobot) -> None:
    await heat_up(carrier)
    body = {"arm": "passive", "reason": "on trial"}
    answer = await carrier.http.patch(LIMP, json=body)

    assert (answer.status_code, answer.json()["state"]) == (200, "passive")
    (told,) = (await carrier.get("/events?kind=reaction.arm_requested"))["items"]
    assert told["data"] == {"part": "carrier", "reaction": "LIMP", **body}
    assert (await carrier.get("/systems/carrier"))["effective_target"]["because"] == "requested"


@pytest.mark.parametrize("body", [{"arm": "perhaps"}, {}, {"arm": "active", "until": 3}])
async def test_what_is_no_arming_is_rejected(carrier: HttpRobot, body: dict[str, object]) -> None:
    answer = await carrier.http.patch(LIMP, json=body)

    assert answer.status_code == 422
    assert (await limp(carrier))["arm"] == "active"


async def test_a_reaction_is_acknowledged(carrier: HttpRobot) -> None:
    await carrier.http.post("/signals/battery_level", json={"value": 0.2})
    await carrier.http.post("/signals/battery_level", json={"value": 0.9})
    assert "reaction:HALT" in {hold["owner"] for hold in (await carrier.get("/holds"))["items"]}

    answer = await carrier.http.post("/systems/carrier/reactions/HALT/acknowledge")

    assert (answer.status_code, answer.json()["state"]) == (200, "idle")
    assert (await carrier.http.delete("/holds/reaction:HALT")).status_code == 409


async def test_an_acknowledgement_with_an_unknown_member_is_rejected(carrier: HttpRobot) -> None:
    answer = await carrier.http.post(f"{LIMP}/acknowledge", json={"reason": "seen"})

    assert (answer.status_code, answer.json()["code"]) == (422, "INVALID_BODY")


async def test_an_unknown_reaction_is_not_found(carrier: HttpRobot) -> None:
    answer = await carrier.http.patch("/nodes/drive/reactions/LIMP", json={"arm": "passive"})

    assert (answer.status_code, answer.json()["code"]) == (404, "UNKNOWN_REACTION")
    lost = await carrier.http.post("/systems/none/reactions/LIMP/acknowledge")
    assert lost.json()["code"] == "UNKNOWN_PART"
