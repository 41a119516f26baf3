"""`/livez`, `/readyz` and `/healthz`: how the service fares, whatever the robot does."""

from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from domain.actor import Actor
from domain.controller import NavigationStatus
from domain.findings import Finding
from domain.graph_terms import GraphFault, GraphFaultKind
from domain.inputs import (
    DriveStatus,
    EmergencyStopRequest,
    Reading,
    Readings,
    SourceFault,
)
from domain.timebase import seconds
from service.simulation.simulated import SimulatedBackend
from service.supervisor import Supervisor
from tests.support.live_robot import make_live_robot, running
from tests.support.manual_clock import ManualClock

ODD = Finding("warning", "INDISTINGUISHABLE_MODES", "WEAK is equal to __DEFAULT__", "manipulator")


@pytest.fixture
def live(clock: ManualClock) -> tuple[Supervisor, SimulatedBackend]:
    return make_live_robot(clock, warnings=[ODD])


@pytest.fixture
def supervisor(live: tuple[Supervisor, SimulatedBackend]) -> Supervisor:
    return live[0]


async def warnings(http: httpx.AsyncClient) -> dict[str, str]:
    return {item["code"]: item["message"] for item in (await health(http))["warnings"]}


async def health(http: httpx.AsyncClient) -> dict[str, Any]:
    answer = await http.get("/healthz")
    assert answer.status_code == 200
    found = answer.json()
    assert isinstance(found, dict)
    return found


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
        supervisor.submit(EmergencyStopRequest(True, "test", Actor("operator")))

        assert (await http.get("/readyz")).status_code == 200
        assert (await health(http))["status"] == "ok"


async def test_what_is_odd_about_the_model_is_a_warning(http: httpx.AsyncClient) -> None:
    assert (await warnings(http))["INDISTINGUISHABLE_MODES"] == ODD.message


async def test_a_sender_with_a_wrong_clock_is_a_warning(
    http: httpx.AsyncClient, supervisor: Supervisor, clock: ManualClock
) -> None:
    await clock.advance(10)
    early = Reading("temperature", 30.0, clock.now() - seconds(5))

    supervisor.readings.submit([early])

    assert "temperature" in (await warnings(http))["CLOCK_SKEW"]


async def test_a_source_that_fails_is_a_warning_until_it_reads_again(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    supervisor.submit(SourceFault("temperature", "file", "no such file"))
    assert (await warnings(http))["SOURCE_FAILS"] == "no reading of temperature: no such file"

    supervisor.submit(Readings((Reading("temperature", 30.0),), "file"))
    assert "SOURCE_FAILS" not in await warnings(http)


async def test_ticks_that_were_late_are_a_warning(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    assert "LATE_TICKS" not in await warnings(http)

    supervisor.publisher.late_ticks = 3

    assert "3 ticks" in (await warnings(http))["LATE_TICKS"]


async def test_a_service_that_anybody_can_reach_warns_of_it(
    http: httpx.AsyncClient, app: FastAPI
) -> None:
    assert "NO_AUTHENTICATION" not in await warnings(http)

    app.state.exposed = True

    assert "NO_AUTHENTICATION" in await warnings(http)


async def test_a_vehicle_that_does_not_tell_where_it_is_is_a_warning(
    http: httpx.AsyncClient, live: tuple[Supervisor, SimulatedBackend], clock: ManualClock
) -> None:
    supervisor, backend = live
    assert (await warnings(http))["NO_POSE"] == "the vehicle never reported a pose"
    async with running(supervisor):
        assert "NO_POSE" not in await warnings(http)
        backend.set_vehicle_fault("silent")
        await clock.advance(1)

        assert (await warnings(http))["NO_POSE"] == "no pose of the vehicle for 0.3 s"


async def test_a_controller_that_is_gone_is_a_warning(
    http: httpx.AsyncClient, live: tuple[Supervisor, SimulatedBackend]
) -> None:
    supervisor, _ = live
    supervisor.deliver(NavigationStatus(available=False, reason="the controller is gone"))
    assert (await warnings(http))["NO_CONTROLLER"] == "the controller is gone"
    supervisor.deliver(NavigationStatus(available=True))

    assert "NO_CONTROLLER" not in await warnings(http)


async def test_a_vehicle_that_cannot_be_commanded_is_a_warning(
    http: httpx.AsyncClient, live: tuple[Supervisor, SimulatedBackend]
) -> None:
    supervisor, _ = live
    supervisor.deliver(DriveStatus(available=False, reason="the drive process has ended"))
    assert (await warnings(http))["NO_DRIVE"] == "the drive process has ended"
    supervisor.deliver(DriveStatus(available=True))

    assert "NO_DRIVE" not in await warnings(http)


@pytest.mark.parametrize(
    ("kind", "code"),
    [
        (GraphFaultKind.QOS, "ROS_QOS"),
        (GraphFaultKind.TYPE, "ROS_TYPE"),
        (GraphFaultKind.DUPLICATE, "ROS_DUPLICATE_NODE"),
    ],
)
async def test_what_is_wrong_in_the_ros_graph_is_a_warning(
    http: httpx.AsyncClient,
    live: tuple[Supervisor, SimulatedBackend],
    kind: GraphFaultKind,
    code: str,
) -> None:
    supervisor, _ = live
    supervisor.deliver(GraphFault(kind, "/scan", "not as it should be"))
    assert (await warnings(http))[code] == "/scan: not as it should be"
    supervisor.deliver(GraphFault(kind, "/scan"))

    assert code not in await warnings(http)
