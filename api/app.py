"""The web application around a supervisor that somebody else runs: its robot, and simulations."""

from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager

from fastapi import FastAPI

from api import posted_models, posted_tasks
from api.robot_app import create_robot_app
from api.routes import simulations
from service.supervisor import Supervisor
from service.worker import Worker

SIMULATION_DEADLINE_S = 120.0


def create_app(supervisor: Supervisor, *, allowed_hosts: Sequence[str]) -> FastAPI:
    """Return the application; it starts no task and no process.

    Whoever serves it calls `prepare` before, and `close_workers` after; its lifespan does the
    second, and starts the worker process before there is work for it. Simulations have a further
    process, started with the first of them: they may take a minute, and a task that is posted
    meanwhile must not wait.

    Args:
        supervisor: What is served.
        allowed_hosts: Names by which this service may be asked, beside those of loopback.
    """
    worker = Worker([posted_models.__name__, posted_tasks.__name__])
    app = create_robot_app(supervisor, worker, allowed_hosts=allowed_hosts, lifespan=_lifespan)
    app.state.simulator = Worker(deadline_s=SIMULATION_DEADLINE_S)
    app.include_router(simulations.router)
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
