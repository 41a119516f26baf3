"""Health of the service, not of the robot: a healthy service may supervise a robot in ERROR."""

from collections.abc import Iterator, Mapping
from http import HTTPStatus
from typing import Annotated, Literal

from fastapi import APIRouter, Depends, Request, Response
from prometheus_client import CONTENT_TYPE_LATEST, generate_latest

from api.http.dependencies import SupervisorDep
from api.http.metrics import Metrics
from api.http.problems import make_problem, problem_response
from api.http.route_policy import Permission, policy
from api.http.schemas.base import Json
from domain.errors import StorageDegradedError
from domain.graph_terms import GraphFaultKind
from domain.snapshot import HoldView
from domain.tasks.holds import DRIVE_HOLD, NAVIGATION_HOLD, VEHICLE_HOLD
from domain.timebase import to_seconds
from service.supervisor import Supervisor

GRAPH_CODES = {
    GraphFaultKind.QOS: "ROS_QOS",
    GraphFaultKind.TYPE: "ROS_TYPE",
    GraphFaultKind.DUPLICATE: "ROS_DUPLICATE_NODE",
}
"""Of warnings, by what is wrong in the ROS graph."""

router = APIRouter(tags=["service"])


class LiveJson(Json):
    """The event loop is running."""

    status: Literal["alive"] = "alive"


class CheckJson(Json):
    """A check that must pass for the service to work."""

    name: str
    ok: bool
    message: str


class WarningJson(Json):
    """Something that works but needs attention."""

    code: str
    message: str


class ReadyJson(Json):
    """The service is ready."""

    status: Literal["ready"] = "ready"
    checks: list[CheckJson]


class HealthJson(Json):
    """The checks and warnings of the service."""

    status: Literal["ok", "failing"]
    checks: list[CheckJson]
    warnings: list[WarningJson]


@router.get("/livez")
@policy(Permission.PROBE)
async def get_livez() -> LiveJson:
    """Report that the event loop is running."""
    return LiveJson()


@router.get("/readyz", response_model=ReadyJson, responses={503: {"description": "Not ready"}})
@policy(Permission.PROBE)
async def get_readyz(supervisor: SupervisorDep, request: Request) -> ReadyJson | Response:
    """Report whether the model is loaded and the core ticks; 503 if not."""
    checks = _checks(supervisor)
    failing = [f"{check.name}: {check.message}" for check in checks if not check.ok]
    if failing:
        status = HTTPStatus.SERVICE_UNAVAILABLE
        return problem_response(
            make_problem(status, "NOT_READY", "; ".join(failing), request.url.path)
        )
    return ReadyJson(checks=checks)


@router.get("/healthz")
@policy(Permission.OBSERVE)
async def get_healthz(supervisor: SupervisorDep, request: Request) -> HealthJson:
    """Return the checks and warnings of the service; always 200."""
    checks = _checks(supervisor)
    exposed = bool(getattr(request.app.state, "exposed", False))
    return HealthJson(
        status="ok" if all(check.ok for check in checks) else "failing",
        checks=checks,
        warnings=list(_warnings(supervisor, exposed=exposed)),
    )


async def _metrics(request: Request) -> Metrics:
    known: Metrics = request.app.state.metrics
    return known


@router.get(
    "/metrics",
    response_class=Response,
    responses={200: {"content": {"text/plain": {"schema": {"type": "string"}}}}},
)
@policy(Permission.OBSERVE)
async def get_metrics(known: Annotated[Metrics, Depends(_metrics)]) -> Response:
    """Return the metrics in the text format of Prometheus."""
    return Response(generate_latest(known.registry), media_type=CONTENT_TYPE_LATEST)


def _checks(supervisor: Supervisor) -> list[CheckJson]:
    model = supervisor.model
    loaded = f"systems: {len(model.systems)}, nodes: {len(model.nodes)}"
    hanging, last = supervisor.hanging(), supervisor.publisher.last_tick_at
    if hanging is not None or last is None:
        ticking = CheckJson(name="core", ok=False, message=hanging or "has not ticked yet")
    else:
        message = f"last tick {to_seconds(supervisor.clock.now() - last):.2f} s ago"
        ticking = CheckJson(name="core", ok=True, message=message)
    return [CheckJson(name="model", ok=True, message=loaded), ticking]


def _vehicle_warnings(holds: Mapping[str, HoldView]) -> Iterator[WarningJson]:
    lost = holds.get(VEHICLE_HOLD)
    if lost is not None:
        yield WarningJson(code="NO_POSE", message=lost.reason)
    undriven = holds.get(DRIVE_HOLD)
    if undriven is not None:
        yield WarningJson(code="NO_DRIVE", message=undriven.reason)
    uncontrolled = holds.get(NAVIGATION_HOLD)
    if uncontrolled is not None:
        yield WarningJson(code="NO_CONTROLLER", message=uncontrolled.reason)


def _warnings(supervisor: Supervisor, *, exposed: bool) -> Iterator[WarningJson]:
    for finding in supervisor.warnings:
        yield WarningJson(code=finding.code, message=finding.message)
    for name, signal in supervisor.core.signals().items():
        if signal.skewed:
            message = f"the clock of the sender of {name} differs from ours by more than 1 s"
            yield WarningJson(code="CLOCK_SKEW", message=message)
        if signal.source_fault is not None:
            message = f"no reading of {name}: {signal.source_fault}"
            yield WarningJson(code="SOURCE_FAILS", message=message)
    yield from _vehicle_warnings(supervisor.core.driving.holds)
    for fault in supervisor.core.graph_faults():
        yield WarningJson(code=GRAPH_CODES[fault.kind], message=f"{fault.name}: {fault.reason}")
    if late := supervisor.publisher.late_ticks:
        message = f"{late} ticks skipped since the start: the machine is too slow"
        yield WarningJson(code="LATE_TICKS", message=message)
    degraded = supervisor.storage.reason
    if degraded is not None:
        message = f"{degraded}; a restart may forget what is asked now"
        yield WarningJson(code=StorageDegradedError.code, message=message)
    if exposed:
        message = "anybody on the network can control the robot: there is no authentication"
        yield WarningJson(code="NO_AUTHENTICATION", message=message)
