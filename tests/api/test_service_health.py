"""`/livez`, `/readyz`, `/healthz` and `/metrics`: how the service fares, whatever the robot does."""

from collections.abc import AsyncIterator
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from prometheus_client.parser import text_string_to_metric_families

from api.app import create_app
from domain.findings import Finding
from domain.messages import EmergencyStopRequest, ModeRequest, Reading
from domain.system_model import PartName
from domain.timebase import seconds
from service.supervisor import Supervisor
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock
from tests.support.websocket import WebSocketClient

ODD = Finding("warning", "INDISTINGUISHABLE_MODES", "WEAK is equal to __DEFAULT__", "manipulator")


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
def supervisor(clock: ManualClock) -> Supervisor:
    return make_supervisor(clock, warnings=[ODD])


@pytest.fixture
def app(supervisor: Supervisor) -> FastAPI:
    return create_app(supervisor, allowed_hosts=[])


@pytest.fixture
async def http(app: FastAPI) -> AsyncIterator[httpx.AsyncClient]:
    transport = httpx.ASGITransport(app)
    async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000") as client:
        yield client


async def warnings(http: httpx.AsyncClient) -> dict[str, str]:
    return {item["code"]: item["message"] for item in (await health(http))["warnings"]}


async def health(http: httpx.AsyncClient) -> dict[str, Any]:
    answer = await http.get("/healthz")
    assert answer.status_code == 200
    found = answer.json()
    assert isinstance(found, dict)
    return found


async def metric(http: httpx.AsyncClient, name: str, **labels: str) -> float | None:
    text = (await http.get("/metrics")).text
    return next(
        (
            sample.value
            for family in text_string_to_metric_families(text)
            for sample in family.samples
            if sample.name == name and sample.labels == labels
        ),
        None,
    )


async def test_a_service_is_alive_before_it_is_ready(http: httpx.AsyncClient) -> None:
    assert (await http.get("/livez")).status_code == 200

    refused = await http.get("/readyz")

    assert refused.status_code == 503
    assert refused.headers["content-type"] == "application/problem+json"
    assert refused.json()["code"] == "NOT_READY"
    assert "has not ticked" in refused.json()["detail"]


async def test_a_service_that_ticks_is_ready(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    async with running(supervisor):
        answer = await http.get("/readyz")

    assert answer.status_code == 200
    assert answer.json()["status"] == "ready"


async def test_a_service_whose_core_stands_still_for_a_second_is_not_ready(
    http: httpx.AsyncClient, supervisor: Supervisor, clock: ManualClock
) -> None:
    async with running(supervisor):
        pass
    await clock.advance(0.99)
    before = await http.get("/readyz")

    await clock.advance(0.01)

    assert before.status_code == 200
    assert (await http.get("/readyz")).status_code == 503
    assert (await health(http))["status"] == "failing"


async def test_a_robot_in_error_is_watched_by_a_healthy_service(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    async with running(supervisor):
        supervisor.submit(EmergencyStopRequest(True, "test", "operator"))

        assert (await http.get("/readyz")).status_code == 200
        assert (await health(http))["status"] == "ok"


async def test_what_is_odd_about_the_model_is_a_warning(http: httpx.AsyncClient) -> None:
    assert (await warnings(http))["INDISTINGUISHABLE_MODES"] == ODD.message


async def test_a_sender_with_a_wrong_clock_is_a_warning(
    http: httpx.AsyncClient, supervisor: Supervisor, clock: ManualClock
) -> None:
    await clock.advance(10)
    early = Reading("temperature", 30.0, clock.now() - seconds(5))

    supervisor.submit_readings([early])

    assert "temperature" in (await warnings(http))["CLOCK_SKEW"]


async def test_ticks_that_were_late_are_a_warning_and_are_counted(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    assert "LATE_TICKS" not in await warnings(http)

    supervisor.late_ticks = 3

    assert "3 ticks" in (await warnings(http))["LATE_TICKS"]
    assert await metric(http, "pilothouse_ticks_late_total") == 3


async def test_a_service_that_anybody_can_reach_warns_of_it(
    http: httpx.AsyncClient, app: FastAPI
) -> None:
    assert "NO_AUTHENTICATION" not in await warnings(http)

    app.state.exposed = True

    assert "NO_AUTHENTICATION" in await warnings(http)


async def test_the_metrics_tell_the_state_and_the_errors_of_the_robot(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    async with running(supervisor):
        supervisor.submit(EmergencyStopRequest(True, "test", "operator"))

        assert await metric(http, "pilothouse_system_state", state="ERROR") == 1
        assert await metric(http, "pilothouse_system_state", state="IDLE") == 0
        assert await metric(http, "pilothouse_error_active", error="ESTOP") == 1
        assert await metric(http, "pilothouse_error_active", error="BATTERY_LOW") is None


async def test_the_metrics_tell_which_parts_are_on_their_way(
    http: httpx.AsyncClient, supervisor: Supervisor, clock: ManualClock
) -> None:
    async with running(supervisor):
        supervisor.submit(ModeRequest(PartName("actuation"), "PERFORMANCE", "operator"))
        assert await metric(http, "pilothouse_part_deviates", part="actuation") == 1

        await clock.advance(2)

        assert await metric(http, "pilothouse_part_deviates", part="actuation") is None


async def test_the_metrics_tell_how_old_a_signal_is(
    http: httpx.AsyncClient, clock: ManualClock, supervisor: Supervisor
) -> None:
    assert await metric(http, "pilothouse_signal_age_seconds", signal="temperature") is None
    supervisor.submit_readings([Reading("temperature", 30.0)])

    await clock.advance(1.5)

    assert await metric(http, "pilothouse_signal_age_seconds", signal="temperature") == 1.5


async def test_the_metrics_count_how_changes_ended(
    http: httpx.AsyncClient, supervisor: Supervisor, clock: ManualClock
) -> None:
    async with running(supervisor):
        assert await metric(http, "pilothouse_changes_total", status="succeeded") == 0
        for mode in ("PERFORMANCE", "MODERATE"):
            supervisor.submit(ModeRequest(PartName("actuation"), mode, "operator"))
            await clock.advance(2)

            await http.get("/metrics")

        assert await metric(http, "pilothouse_changes_total", status="succeeded") == 2
        assert await metric(http, "pilothouse_changes_total", status="failed") == 0


async def test_the_metrics_tell_the_period_of_the_tick(
    http: httpx.AsyncClient, supervisor: Supervisor, clock: ManualClock
) -> None:
    await http.get("/metrics")
    async with running(supervisor):
        await clock.advance(1)

    assert await metric(http, "pilothouse_publish_period_seconds_count") == 20
    assert await metric(http, "pilothouse_publish_period_seconds_sum") == pytest.approx(1)


async def test_the_metrics_count_the_clients_of_the_stream(
    http: httpx.AsyncClient, app: FastAPI, supervisor: Supervisor
) -> None:
    async with running(supervisor):
        async with WebSocketClient(app) as client:
            await client.frame()
            assert await metric(http, "pilothouse_ws_clients") == 1

        assert await metric(http, "pilothouse_ws_clients") == 0
        assert await metric(http, "pilothouse_ws_dropped_total") == 0
        assert await metric(http, "pilothouse_ws_frames_skipped_total") == 0
