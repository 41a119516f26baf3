from http import HTTPStatus
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from api.http.access import Access
from api.http.gate.rate import RateGate, TokenBuckets
from api.http.gate.refusals import Refusals
from api.http.limits import ServiceLimits
from domain.timebase import seconds
from tests.support.asgi import answer_200, messages_of, status_of, websocket_scope
from tests.support.http_robot import declared_policies, http_robot, http_scope
from tests.support.manual_clock import ManualClock

# --- the buckets --------------------------------------------------------------------------------


def taken(buckets: TokenBuckets, address: str, now_s: float, tries: int) -> int:
    return sum(buckets.take(address, seconds(now_s)) == 0 for _ in range(tries))


def test_a_quiet_client_may_ask_for_two_seconds_worth_at_once() -> None:
    assert taken(TokenBuckets(per_s=10), "a", 0, 100) == 20


def test_then_it_may_ask_as_often_as_is_set() -> None:
    buckets = TokenBuckets(per_s=10)
    taken(buckets, "a", 0, 100)

    assert [taken(buckets, "a", at_s, 100) for at_s in (0.05, 0.1, 1.1, 1.1, 101.1)] == [
        0,
        1,
        10,
        0,
        20,
    ]


def test_who_is_refused_is_told_when_to_come_again() -> None:
    buckets = TokenBuckets(per_s=10)
    taken(buckets, "a", 0, 20)

    missing = buckets.take("a", seconds(0.03))

    assert missing == seconds(0.07)
    assert buckets.take("a", seconds(0.03) + missing) == 0


def test_who_asks_in_vain_does_not_wait_the_longer_for_it() -> None:
    buckets = TokenBuckets(per_s=10)
    taken(buckets, "a", 0, 10_000)

    assert buckets.take("a", seconds(0.1)) == 0


def test_one_client_takes_nothing_from_another() -> None:
    buckets = TokenBuckets(per_s=10)
    taken(buckets, "a", 0, 100)

    assert taken(buckets, "b", 0, 100) == 20


def test_the_table_is_bounded_however_many_addresses_there_are() -> None:
    buckets = TokenBuckets(per_s=1, max_addresses=100)

    for number in range(10_000):
        buckets.take(f"{number}", 0)
        assert len(buckets) <= 100


def test_those_who_asked_least_are_forgotten_first() -> None:
    buckets = TokenBuckets(per_s=10, max_addresses=10)
    taken(buckets, "greedy", 0, 20)
    for number in range(1_000):
        buckets.take(f"{number}", 0)

    assert taken(buckets, "greedy", 0, 1) == 0


@given(st.lists(st.tuples(st.integers(0, 3 * 10**9), st.sampled_from("ab")), max_size=200))
def test_nobody_ever_asks_more_than_its_share(asked: list[tuple[int, str]]) -> None:
    buckets, now, granted = TokenBuckets(per_s=5), 0, {"a": 0, "b": 0}

    for wait, address in asked:
        now += wait // 50
        granted[address] += buckets.take(address, now) == 0

    assert all(count <= 10 + 5 * now / 10**9 for count in granted.values())


# --- the gate -----------------------------------------------------------------------------------


def gate(per_s: int, clock: ManualClock) -> RateGate:
    return RateGate(answer_200, per_s, clock, declared_policies(), Refusals(clock))


async def test_who_asks_too_often_is_told_so_and_when_to_come_again() -> None:
    limits = ServiceLimits(requests_per_s=1)
    async with http_robot(limits=limits) as robot:
        events = robot.supervisor.events.newest
        answers = [await robot.http.get("/systems") for _ in range(3)]

        assert [answer.status_code for answer in answers] == [200, 200, 429]
        assert answers[2].headers["retry-after"] == "1"
        assert answers[2].headers["x-content-type-options"] == "nosniff"
        assert answers[2].json()["code"] == "TOO_MANY_REQUESTS"
        assert "more than 1 requests a second" in answers[2].json()["detail"]
        assert robot.app.state.refusals.counts == {HTTPStatus.TOO_MANY_REQUESTS: 1}
        assert robot.supervisor.events.newest == events

        await robot.pass_time(1)

        assert (await robot.http.get("/systems")).status_code == 200


async def test_a_handshake_counts_as_a_request() -> None:
    limited = gate(1, ManualClock())

    sent = [(await messages_of(limited, websocket_scope({})))[0]["type"] for _ in range(3)]

    assert sent == ["http.response.start", "http.response.start", "websocket.close"]


async def test_a_client_without_an_address_is_limited_like_another() -> None:
    limited, scope = gate(1, ManualClock()), {**http_scope("GET", "/systems"), "client": None}

    assert [await status_of(limited, scope) for _ in range(3)] == [200, 200, 429]


async def test_the_start_of_the_service_is_no_request() -> None:
    limited: Any = gate(1, ManualClock())
    seen = []

    async def send(message: object) -> None:
        seen.append(message)

    for _ in range(5):
        await limited({"type": "lifespan"}, None, send)

    assert len(seen) == 5


SAFE = [
    ("PUT", "/emergency_stop"),
    ("PUT", "/holds/operator"),
    ("DELETE", "/tasks/current"),
    ("POST", "/signals"),
    ("POST", "/signals/estop"),
    ("GET", "/livez"),
    ("HEAD", "/readyz"),
]


@pytest.mark.parametrize(("method", "path"), SAFE)
async def test_what_makes_the_robot_safe_is_never_refused_for_being_asked_too_often(
    method: str, path: str
) -> None:
    limited = gate(1, ManualClock())
    while await status_of(limited, http_scope("GET", "/systems")) == 200:
        pass

    assert [await status_of(limited, http_scope(method, path)) for _ in range(5)] == [200] * 5


@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("GET", "/emergency_stop"),
        ("DELETE", "/holds/operator"),
        ("POST", "/tasks"),
        ("DELETE", "/tasks/t1"),
        ("GET", "/signals"),
        ("POST", "/signalsx"),
        ("POST", "/livez"),
        ("PATCH", "/mock/estop"),
        ("GET", "/healthz"),
    ],
)
async def test_nothing_else_is_free(method: str, path: str) -> None:
    limited = gate(1, ManualClock())

    assert [await status_of(limited, http_scope(method, path)) for _ in range(3)] == [200, 200, 429]


async def test_a_stop_gets_through_to_the_robot_though_its_client_asks_too_often() -> None:
    async with http_robot(limits=ServiceLimits(requests_per_s=1)) as robot:
        while (await robot.http.get("/systems")).status_code == 200:
            pass

        answer = await robot.http.put("/emergency_stop", json={"engaged": True, "reason": "now"})

        assert answer.status_code == 200
        assert robot.supervisor.core.emergency_stop().engaged


async def test_who_tries_tokens_is_limited_as_well() -> None:
    access = Access.with_token("correct-horse-battery")
    async with http_robot(access=access, limits=ServiceLimits(requests_per_s=1)) as robot:
        statuses = [(await robot.http.get("/systems")).status_code for _ in range(3)]

    assert statuses == [401, 401, 429]
