"""Build the web application around a supervisor that somebody else runs."""

from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from functools import partial

from fastapi import FastAPI
from starlette.middleware import Middleware

from api import posted_models, posted_tasks
from api.distribution import installed_version
from api.gate import Gate, SecurityHeaders, UnexpectedErrors
from api.openapi import describe
from api.problem_handlers import add_problem_handlers
from api.routes import (
    changes,
    emergency_stop,
    events,
    example_tracks,
    holds,
    inference,
    mock,
    model,
    parameters,
    parts,
    service_health,
    signals,
    simulations,
    stream,
    system_state,
    tasks,
    vehicle,
)
from api.static_page import page_routes
from service.jobs import Jobs
from service.supervisor import Supervisor
from service.worker import Worker

_RESOURCES = (
    # Before the parts: the path of a part matches everything below /nodes.
    parameters.router,
    changes.router,
    model.router,
    inference.router,
    signals.router,
    system_state.router,
    emergency_stop.router,
    mock.router,
    tasks.router,
    holds.router,
    vehicle.router,
    example_tracks.router,
    simulations.router,
    events.router,
    stream.router,
    service_health.router,
)


SIMULATION_DEADLINE_S = 120.0


def create_app(
    supervisor: Supervisor,
    *,
    allowed_hosts: Sequence[str],
    worker: Jobs | None = None,
    simulator: Jobs | None = None,
) -> FastAPI:
    """Return the application; it starts no task and no process.

    Whoever serves it calls `prepare` before, and `close_workers` after; its lifespan does the
    second, and starts the worker process before there is work for it.

    Args:
        supervisor: What is served.
        allowed_hosts: Names by which this service may be asked, beside those of loopback.
        worker: Does what would keep the event loop; None: a process of its own.
        simulator: Runs simulations; None: a further process, started with the first of them, since
            they may take a minute, and a task that is posted meanwhile must not wait.
    """
    app = FastAPI(
        title="Pilothouse",
        summary="States and modes of a robot's systems and nodes, its health, and why",
        version=installed_version(),
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        lifespan=_lifespan,
        # "default" keeps the framework from describing an answer that is never given.
        responses={"default": {"description": "A problem"}},
        middleware=[
            Middleware(SecurityHeaders),
            Middleware(Gate, allowed_hosts=allowed_hosts),
            Middleware(UnexpectedErrors),
        ],
    )
    app.state.supervisor = supervisor
    app.state.worker = worker or Worker([posted_models.__name__, posted_tasks.__name__])
    app.state.simulator = simulator or Worker(deadline_s=SIMULATION_DEADLINE_S)
    app.state.model_json = model.encode_model(supervisor)
    add_problem_handlers(app, supervisor.clock)
    for router in _RESOURCES:
        app.include_router(router)
    for prefix in ("systems", "nodes"):
        app.include_router(parts.router, prefix=f"/{prefix}", tags=[prefix])
    app.include_router(page_routes())
    app.openapi = partial(describe, app)  # type: ignore[method-assign]
    return app


def prepare(app: FastAPI) -> None:
    """Build what the framework would build at the first requests.

    It takes some 0.2 s, in which nothing else is done: before the robot is supervised these do no
    harm.
    """
    app.openapi()


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    await app.state.worker.start()
    try:
        yield
    finally:
        await close_workers(app)


async def close_workers(app: FastAPI) -> None:
    """End the processes that work for `app`; what they are at fails."""
    await app.state.worker.close()
    await app.state.simulator.close()
