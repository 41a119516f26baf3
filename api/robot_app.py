"""The HTTP interface of one robot, live or in a simulation."""

from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from functools import cache, partial
from typing import TypeAlias

from fastapi import APIRouter, FastAPI
from starlette.middleware import Middleware
from starlette.routing import BaseRoute

from api.distribution import installed_version
from api.documents.openapi import describe
from api.documents.route import openapi_router
from api.http.access import Access
from api.http.gate.durable import DurableHeader
from api.http.gate.faults import UnexpectedErrors
from api.http.gate.head import HeadAsGet
from api.http.gate.query import QueryGate
from api.http.gate.refusals import Refusals
from api.http.limits import USUAL_LIMITS, ServiceLimits
from api.http.metrics import Metrics
from api.http.page.routes import page_routes
from api.http.problem_handlers import add_problem_handlers
from api.http.route_table import RouteTable
from api.http.routes import (
    analysis,
    announcing,
    changes,
    checkpoints,
    devices,
    emergency_stop,
    error_reports,
    errors,
    example_tracks,
    holds,
    inference,
    mock,
    model,
    monitors,
    parameters,
    parts,
    processes,
    reactions,
    service_health,
    signals,
    simulated,
    storage,
    system_state,
    tasks,
    vehicle,
)
from api.streaming import events_route as events
from api.streaming import route as stream
from api.streaming.first_frames import first_frames
from api.streaming.stream_metrics import StreamCollector
from api.streaming.stream_server import StreamServer
from service.clock import Clock
from service.supervisor import Supervisor
from service.worker import Jobs

_RESOURCES = (
    openapi_router,
    # Before the parts: the path of a part matches everything below /nodes.
    parameters.router,
    checkpoints.router,
    processes.router,
    changes.router,
    model.router,
    inference.router,
    signals.router,
    monitors.router,
    system_state.router,
    errors.router,
    reactions.router,
    announcing.router,
    error_reports.router,
    analysis.router,
    emergency_stop.router,
    devices.router,
    mock.router,
    simulated.router,
    tasks.router,
    holds.router,
    vehicle.router,
    example_tracks.router,
    events.router,
    stream.router,
    storage.router,
    service_health.router,
)


@cache
def _resources() -> list[BaseRoute]:
    """Return the routes of all resources, which the applications of this process share.

    FastAPI analyses the routes of a router anew where it is included, and keeps both: so only those
    are included that are there with several prefixes.
    """
    routes = [route for resource in _RESOURCES for route in resource.routes]
    of_parts = APIRouter()
    of_parts.include_router(announcing.part_router, prefix="/devices", tags=["devices"])
    for prefix in ("systems", "nodes"):
        resources = (
            announcing.part_router,
            error_reports.part_router,
            reactions.part_router,
            parts.router,
        )
        for resource in resources:
            of_parts.include_router(resource, prefix=f"/{prefix}", tags=[prefix])
    return [RouteTable([*routes, *of_parts.routes])]


Lifespan: TypeAlias = Callable[[FastAPI], AbstractAsyncContextManager[None]]


def create_robot_app(
    supervisor: Supervisor,
    worker: Jobs,
    *,
    access: Access | None = None,
    limits: ServiceLimits = USUAL_LIMITS,
    lifespan: Lifespan | None = None,
    clock: Clock | None = None,
) -> FastAPI:
    """Return the interface, without what guards it against the network; it starts no task.

    Args:
        supervisor: What is served.
        worker: Does what would keep the event loop.
        access: Whom it lets in; None: everybody.
        limits: How much may be asked of it.
        lifespan: What is to be done before the first and after the last request.
        clock: Of the connections; None: that of the supervisor.
    """
    app = FastAPI(
        title="Pilothouse",
        summary="States and modes of a robot's systems and nodes, its health, and why",
        version=installed_version(),
        # Its own routes declare no policy; ours are in api.documents.
        openapi_url=None,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        lifespan=lifespan,
        routes=_resources(),
        middleware=_inner_gates(supervisor.clock),
    )
    state = app.state
    state.worker = worker
    state.access = access or Access.open()
    state.limits = limits
    state.refusals = Refusals(clock or supervisor.clock)
    state.metrics = Metrics(supervisor, state.refusals)
    show(app, supervisor, clock)
    state.metrics.registry.register(StreamCollector(state.stream_server))
    add_problem_handlers(app, supervisor.clock)
    # The stream server is another one after the robot of a recording was replaced.
    app.include_router(page_routes(lambda: first_frames(state.stream_server)))
    app.openapi = partial(describe, app)  # type: ignore[method-assign]
    return app


def _inner_gates(clock: Clock) -> list[Middleware]:
    """Return what is before the routes of a robot in a simulation as well; the first is outermost.

    Args:
        clock: Of the robot.
    """
    return [
        Middleware(DurableHeader),
        Middleware(UnexpectedErrors),
        Middleware(QueryGate, clock=clock),
        Middleware(HeadAsGet),
    ]


def show(app: FastAPI, supervisor: Supervisor, clock: Clock | None = None) -> None:
    """Let routes and gates find the robot.

    Args:
        app: Of `create_robot_app`.
        supervisor: What is served from now on.
        clock: Of the connections; None: that of the supervisor.
    """
    state = app.state
    state.supervisor = supervisor
    state.model_json = model.encode_model(supervisor)
    state.stream_server = StreamServer(
        supervisor, state.limits.stream_clients, state.access, state.refusals, clock
    )
