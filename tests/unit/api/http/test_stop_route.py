"""A stop is taken over HTTP, whatever stands around it."""

import asyncio
import json
from collections.abc import AsyncIterator
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.around_a_stop import ANY, ASKING, MEMBERS, WRAPPED, object_of
from tests.support.http_robot import HttpRobot, http_robot

STOP, READING, BATCH, MOCK = "/emergency_stop", "/signals/estop", "/signals", "/mock/estop"
_METHODS = {STOP: "PUT", READING: "POST", BATCH: "POST", MOCK: "PATCH"}


async def _send(robot: HttpRobot, path: str, body: str | bytes) -> Any:  # noqa: ANN401
    return await robot.http.request(_METHODS[path], path, content=body)


def _is_stopped(robot: HttpRobot) -> bool:
    return "ESTOP" in robot.supervisor.core.system_state().errors


@pytest.mark.parametrize(
    ("path", "body", "pointer"),
    [
        (READING, '{"value":true,"stamp":"garbage"}', "/stamp"),
        (READING, '{"value":true,"stamp":17}', "/stamp"),
        (READING, '{"value":true,"source":"' + "x" * 65 + '"}', "/source"),
        (READING, '{"value":true,"header":{"stamp":null}}', "/header"),
        (READING, '{"value":true,"value":false}', ""),
        (READING, '{"value":false,"value":true}', ""),
        (READING, '{"value":true,"x":{"a":1,"a":2}}', ""),
        (READING, '{"value":true,"x":' + "[" * 50_000 + "]" * 50_000 + "}", ""),
        (READING, '{"value":true,"x":' + "1" * 5_000 + "}", ""),
        (READING, '{"value":true,"source":"\\ud800"}', ""),
        (READING, b'{"value":true,"source":"\xff"}', ""),
        (READING, '{"value":true,"stamp":}', ""),
        (READING, '{"value": true', ""),
        (STOP, '{"engaged": true}x', ""),
        (READING, "value=true", ""),
        (BATCH, '{"battery_level":5,"estop":true}', "/battery_level"),
        (BATCH, '{"estop":true,"nothing":1}', "/nothing"),
        (BATCH, '{"estop":true,"temperature":{"of":[1]}}', "/temperature"),
        (BATCH, '{"estop":true,"estop":false}', ""),
        (BATCH, '{"estop":true,"source":"","temperature":null}', "/temperature"),
        (STOP, '{"engaged":true,"engaged":false}', ""),
        (STOP, '{"engaged":true,"reason":17}', "/reason"),
        (STOP, '{"engaged":true,"reason":"' + "x" * 501 + '"}', "/reason"),
        (STOP, '{"engaged":true,"who":{"me":null}}', "/who"),
        (STOP, '{"engaged":1}', "/engaged"),
        (STOP, '{"engaged":"true"}', "/engaged"),
        (MOCK, '{"value":true,"publishing":"perhaps"}', "/publishing"),
        (READING, '[{"value":true}]', ""),
        (READING, '{"value":{"value":true}}', "/value"),
        (READING, '{"value":true,"x":"' + "x" * 300_000 + '"}', ""),
        (READING, '{"value":true,' + ",".join(f'"m{n}":{n}' for n in range(1_500)) + "}", ""),
        (STOP, '{"engaged":true,"x":"' + "x" * 300_000 + '"}', ""),
        (STOP, '{"engaged":true}'.encode("utf-16"), ""),
        (STOP, '{"Engaged":true}', "/engaged"),
        (BATCH, '{"/estop":true,"estop":false}', "/estop"),
        (BATCH, '{"estop":{"value":true}}', "/estop"),
        (BATCH, '{"signals":[{"signal":"estop","value":true}]}', "/signals"),
    ],
    ids=range(37),
)
async def test_a_stop_is_taken_and_what_was_ignored_is_told(
    robot: HttpRobot, path: str, body: str | bytes, pointer: str
) -> None:
    answer = await _send(robot, path, body)

    assert answer.status_code == 200, answer.text
    assert _is_stopped(robot)
    if path != MOCK:
        assert answer.json()["ignored"][0]["pointer"] == pointer


@pytest.mark.parametrize(
    ("path", "body"),
    [
        (READING, '{"value":1}'),
        (READING, '{"value":"TRUE"}'),
        (READING, '{"value":true,"stamp":null,"source":null}'),
        (BATCH, '{"estop":1,"battery_level":1.0000001}'),
        (STOP, '{"engaged":true,"reason":null}'),
    ],
)
async def test_nothing_is_ignored_of_what_is_valid(robot: HttpRobot, path: str, body: str) -> None:
    answer = await _send(robot, path, body)

    assert "ignored" not in answer.json()
    assert _is_stopped(robot)


@pytest.mark.parametrize("path", ["/signals//estop", "/signals/%2Festop", "/mock//estop"])
async def test_a_signal_is_known_by_the_name_of_its_topic(robot: HttpRobot, path: str) -> None:
    method = "PATCH" if path.startswith("/mock") else "POST"

    assert (await robot.http.request(method, path, json={"value": True})).status_code == 200
    assert _is_stopped(robot)


async def test_signals_of_a_batch_are_known_by_the_names_of_their_topics(robot: HttpRobot) -> None:
    await _send(robot, BATCH, '{"/battery_level":0.6,"temperature":20}')

    assert (await robot.get("/signals/battery_level"))["value"] == 0.6
    twice = await _send(robot, BATCH, '{"/battery_level":0.7,"battery_level":0.8}')
    assert (twice.status_code, twice.json()["errors"][0]["pointer"]) == (422, "/battery_level")


async def test_a_connection_ends_after_a_stop_whose_body_was_not_read_to_its_end(
    robot: HttpRobot,
) -> None:
    answer = await _send(robot, STOP, '{"engaged":true,"x":"' + "x" * 300_000 + '"}')

    assert answer.headers["connection"] == "close"


async def test_the_rest_of_a_batch_is_not_taken(robot: HttpRobot) -> None:
    await _send(robot, BATCH, '{"battery_level":0.6,"estop":true,"temperature":"hot"}')

    assert (await robot.get("/signals/battery_level"))["value"] == 1.0


async def test_a_reason_that_is_too_long_is_cut(robot: HttpRobot) -> None:
    answer = await _send(robot, STOP, json.dumps({"engaged": True, "reason": "x" * 700}))

    assert answer.json()["reason"] == "x" * 500


async def test_a_source_is_kept_beside_what_is_ignored(robot: HttpRobot) -> None:
    await _send(robot, READING, '{"value":true,"source":"panel","stamp":"garbage"}')

    assert (await robot.get("/signals/estop"))["source"] == "panel"


@pytest.mark.parametrize(
    ("path", "body", "status"),
    [
        (STOP, '{"engaged":false,"engaged":false}', 400),
        (STOP, '{"engaged":0}', 422),
        (STOP, '{"engaged":null}', 422),
        (STOP, '{"engaged":"maybe"}', 422),
        (STOP, '{"reason":"x"}', 422),
        (STOP, '{"engaged":false,"who":"me"}', 422),
        (READING, '{"value":null}', 422),
        (READING, '{"value":"maybe"}', 422),
        (READING, '{"value":0}', 422),
        (READING, '{"value":false,"stamp":"garbage"}', 422),
        (BATCH, '{"estop":false,"battery_level":5}', 422),
        (BATCH, '{"estop":false,"estop":false}', 400),
    ],
)
async def test_what_does_not_ask_for_a_stop_exactly_neither_engages_nor_releases(
    robot: HttpRobot, path: str, body: str, status: int
) -> None:
    assert (await _send(robot, path, body)).status_code == status
    assert not _is_stopped(robot)

    await robot.http.put(STOP, json={"engaged": True})
    await robot.http.post(READING, json={"value": True})
    assert (await _send(robot, path, body)).status_code == status
    assert (await robot.get(STOP))["engaged"] is True
    assert (await robot.get(READING))["value"] is True


async def test_a_rejected_reading_is_in_the_log_and_in_the_metrics(
    robot: HttpRobot, caplog: pytest.LogCaptureFixture
) -> None:
    await _send(robot, BATCH, '{"temperature":"hot"}')
    await _send(robot, READING, '{"value":"maybe"}')

    assert "rejected a reading of http:127.0.0.1" in caplog.text
    metrics = (await robot.http.get("/metrics")).text
    assert 'pilothouse_readings_refused_total{way="http"} 2.0' in metrics


async def test_a_stop_that_was_taken_is_no_rejected_reading(robot: HttpRobot) -> None:
    await _send(robot, READING, '{"value":true,"stamp":"garbage"}')

    assert robot.supervisor.refused_readings.counts == {}


# --- whatever stands around it -------------------------------------------------------------------

_MEMBERS = {STOP: "engaged", READING: "value", BATCH: "estop"}
_PATHS = st.sampled_from([*_MEMBERS])


@given(_PATHS, MEMBERS, ASKING, MEMBERS, WRAPPED)
def test_whatever_stands_around_it_a_stop_is_taken(
    path: str,
    before: list[tuple[str, object]],
    asking: object,
    after: list[tuple[str, object]],
    wrapped: str,
) -> None:
    async def story() -> None:
        async with http_robot() as robot:
            body = wrapped % object_of([*before, (_MEMBERS[path], asking), *after])
            answer = await _send(robot, path, body)
            assert answer.status_code == 200, answer.text
            assert _is_stopped(robot)

    asyncio.run(story())


@given(_PATHS, MEMBERS, ANY, WRAPPED)
def test_only_exactly_false_releases_a_stop(
    path: str, around: list[tuple[str, object]], value: object, wrapped: str
) -> None:
    async def story() -> None:
        async with http_robot() as robot:
            await robot.http.put(STOP, json={"engaged": True})
            await robot.http.post(READING, json={"value": True})
            await _send(robot, path, wrapped % object_of([*around, (_MEMBERS[path], value)]))
            is_whole = wrapped in ("%s", "\ufeff%s")
            names = [name for name, _ in around]
            if value is not False or _MEMBERS[path] in names or not is_whole:
                assert (await robot.get(STOP))["engaged"] is True
                assert (await robot.get(READING))["value"] is True

    asyncio.run(story())


@pytest.fixture
async def robot() -> AsyncIterator[HttpRobot]:
    async with http_robot() as robot:
        yield robot
