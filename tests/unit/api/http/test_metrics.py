"""`GET /metrics`: what Prometheus is told."""

import httpx
import pytest
from prometheus_client.parser import text_string_to_metric_families

from api.app import create_app
from domain.actor import Actor
from domain.inputs import (
    EmergencyStopRequest,
    HoldRequest,
    ModeRequest,
    NodeReport,
    Reading,
    TaskRequest,
)
from domain.state_and_mode import PartName
from domain.timebase import seconds
from service.source_status import SourceStatus
from service.supervisor import Supervisor
from tests.support.carrier import CARRIER
from tests.support.frames import event
from tests.support.http_robot import http_robot
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock
from tests.support.paths import straight


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


async def test_the_metrics_tell_the_state_and_the_errors_of_the_robot(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    async with running(supervisor):
        supervisor.submit(EmergencyStopRequest(True, "test", Actor("operator")))

        assert await metric(http, "pilothouse_system_state", state="ERROR") == 1
        assert await metric(http, "pilothouse_system_state", state="IDLE") == 0
        assert await metric(http, "pilothouse_error_active", error="ESTOP") == 1
        assert await metric(http, "pilothouse_error_active", error="BATTERY_LOW") is None


async def test_the_metrics_count_the_errors_by_severity(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    name = "pilothouse_errors"
    async with running(supervisor):
        supervisor.submit(EmergencyStopRequest(True, "test", Actor("operator")))
        supervisor.submit(NodeReport(PartName("drive_base"), reachable=True))
        before = await metric(http, name, severity="urgent")
        supervisor.submit(NodeReport(PartName("drive_base"), reachable=False))
        assert before is not None
        assert await metric(http, name, severity="urgent") == before + 1
        assert await metric(http, name, severity="critical")
        assert await metric(http, name, severity="fatal") == 0


async def test_the_metrics_count_the_parts_with_an_error(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    name = "pilothouse_part_errors"
    async with running(supervisor):
        assert not await metric(http, name, error="UNREACHABLE")
        for node in ("drive_base", "manipulator"):
            supervisor.submit(NodeReport(PartName(node), reachable=False))
        assert await metric(http, name, error="UNREACHABLE") == 2
        supervisor.submit(NodeReport(PartName("drive_base"), reachable=True))
        assert await metric(http, name, error="UNREACHABLE") == 1


async def test_the_metrics_tell_which_parts_are_on_their_way(
    http: httpx.AsyncClient, supervisor: Supervisor, clock: ManualClock
) -> None:
    async with running(supervisor):
        supervisor.submit(ModeRequest(PartName("actuation"), "PERFORMANCE", Actor("operator")))
        assert await metric(http, "pilothouse_part_deviates", part="actuation") == 1

        await clock.advance(2)

        assert await metric(http, "pilothouse_part_deviates", part="actuation") is None


async def test_the_metrics_tell_how_old_a_signal_is(
    http: httpx.AsyncClient, clock: ManualClock, supervisor: Supervisor
) -> None:
    assert await metric(http, "pilothouse_signal_age_seconds", signal="temperature") is None
    supervisor.readings.submit([Reading("temperature", 30.0)])

    await clock.advance(1.5)

    assert await metric(http, "pilothouse_signal_age_seconds", signal="temperature") == 1.5


async def test_the_metrics_count_how_changes_ended(
    http: httpx.AsyncClient, supervisor: Supervisor, clock: ManualClock
) -> None:
    async with running(supervisor):
        assert await metric(http, "pilothouse_changes_total", status="succeeded") == 0
        for mode in ("PERFORMANCE", "MODERATE"):
            supervisor.submit(ModeRequest(PartName("actuation"), mode, Actor("operator")))
            await clock.advance(2)

            await http.get("/metrics")

        assert await metric(http, "pilothouse_changes_total", status="succeeded") == 2
        assert await metric(http, "pilothouse_changes_total", status="failed") == 0


async def test_a_change_is_counted_however_much_happened_since_the_last_question(
    http: httpx.AsyncClient, supervisor: Supervisor, clock: ManualClock
) -> None:
    async with running(supervisor):
        supervisor.submit(ModeRequest(PartName("actuation"), "PERFORMANCE", Actor("operator")))
        await clock.advance(2)
    log = supervisor.events
    for number in range(log.newest + 1, log.newest + 10_002):
        log.append(event(number))

    assert await metric(http, "pilothouse_changes_total", status="succeeded") == 1


async def test_the_metrics_tell_the_period_of_the_tick(
    http: httpx.AsyncClient, supervisor: Supervisor, clock: ManualClock
) -> None:
    await http.get("/metrics")
    async with running(supervisor):
        await clock.advance(1)

    assert await metric(http, "pilothouse_publish_period_seconds_count") == 20
    assert await metric(http, "pilothouse_publish_period_seconds_sum") == pytest.approx(1)


async def test_the_metrics_count_the_ticks_that_were_skipped(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    assert await metric(http, "pilothouse_ticks_late_total") == 0

    supervisor.publisher.late_ticks = 3

    assert await metric(http, "pilothouse_ticks_late_total") == 3


async def test_two_services_in_one_process_do_not_mix_their_metrics(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    other = make_supervisor()
    other.publisher.late_ticks = 7
    create_app(other, allowed_hosts=[])

    assert await metric(http, "pilothouse_ticks_late_total") == 0


async def test_a_service_asked_twice_counts_each_tick_once(
    http: httpx.AsyncClient, supervisor: Supervisor, clock: ManualClock
) -> None:
    for _ in range(2):
        await http.get("/metrics")
    async with running(supervisor):
        await clock.advance(0.5)

    assert await metric(http, "pilothouse_publish_period_seconds_count") == 10


async def test_a_task_is_told_by_progress_and_error_and_its_holds_by_owner(
    http: httpx.AsyncClient, supervisor: Supervisor, clock: ManualClock
) -> None:
    async with running(supervisor):
        assert await metric(http, "pilothouse_task_progress_ratio") is None
        supervisor.submit(TaskRequest(straight(), 0, "stanley", 2.8))
        await clock.advance(5)
        supervisor.submit(HoldRequest("operator", "lunch"))

        progress = await metric(http, "pilothouse_task_progress_ratio")
        assert progress == pytest.approx(0.5, abs=0.1)
        assert await metric(http, "pilothouse_cross_track_error_meters") == pytest.approx(0.0)
        assert await metric(http, "pilothouse_hold_active", owner="operator") == 1.0


async def test_the_metrics_tell_how_the_sources_are_doing(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    supervisor.sources = (
        SourceStatus("os", ("cpu",), reads=7, failures=2, duration=seconds(0.002)),
        SourceStatus("topic /scan", ("scan",)),
    )

    assert await metric(http, "pilothouse_source_reads_total", source="os") == 7
    assert await metric(http, "pilothouse_source_failures_total", source="os") == 2
    assert await metric(http, "pilothouse_source_duration_seconds", source="os") == 0.002
    assert await metric(http, "pilothouse_source_duration_seconds", source="topic /scan") is None


async def test_who_was_turned_away_is_counted_by_why(http: httpx.AsyncClient) -> None:
    assert await metric(http, "pilothouse_requests_refused_total", status="403") == 0

    await http.get("/systems", headers={"host": "evil.example"})

    assert await metric(http, "pilothouse_requests_refused_total", status="403") == 1
    assert await metric(http, "pilothouse_requests_refused_total", status="401") == 0
    assert await metric(http, "pilothouse_requests_refused_total", status="429") == 0


async def test_the_metrics_count_the_reactions_by_how_they_stand() -> None:
    name = "pilothouse_reactions"
    async with http_robot(CARRIER) as robot:
        await robot.http.post("/systems/carrier/mode", json={"mode": "__DEFAULT__"})
        await robot.pass_time(1)
        assert await metric(robot.http, name, state="idle") == 2
        await robot.http.post("/signals/temperature", json={"value": 45.0})
        await robot.pass_time(0.5)
        assert await metric(robot.http, name, state="acting") == 1
        assert await metric(robot.http, name, state="idle") == 1
        assert await metric(robot.http, name, state="exhausted") == 0
