"""The web application around a supervisor that somebody else runs: its robot, and simulations."""

import asyncio
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from functools import partial

from fastapi import FastAPI

from api.documents import route as documents
from api.documents.asyncapi import stream_document
from api.documents.route import encode_description, keep_description, keep_stream_description
from api.http import model_jobs, task_jobs
from api.http.access import Access
from api.http.gate.audit import Audit
from api.http.gate.cors import CorsHeaders
from api.http.gate.ending import Ending
from api.http.gate.headers import SecurityHeaders
from api.http.gate.origin import OriginGate
from api.http.gate.origins import AllowedOrigins
from api.http.gate.policies import RoutePolicies
from api.http.gate.rate import RateGate
from api.http.gate.target import TargetGate
from api.http.gate.token import TokenGate
from api.http.limits import USUAL_LIMITS, ServiceLimits
from api.http.page.assembled_page import assembled_page
from api.robot_app import create_robot_app
from api.rosbridge import route as rosbridge
from api.rosbridge.clients import make_rosbridge_clients
from api.simulation import route as simulations
from api.simulation.simulation_job import SimulatedParts
from api.streaming import frame_jobs, frames_route
from service.forked_call import ForkedCallError, forked_call
from service.ros.interface.settings import USUAL_SETTINGS, InterfaceSettings
from service.supervisor import Supervisor
from service.worker import Worker

SIMULATION_DEADLINE_S = 120.0
REPLAY_DEADLINE_S = 30.0
"""For a moment of the record; the last checkpoint before it is some minutes earlier at most."""


def create_app(
    supervisor: Supervisor,
    *,
    allowed_hosts: Sequence[str],
    allowed_origins: AllowedOrigins | None = None,
    access: Access | None = None,
    limits: ServiceLimits = USUAL_LIMITS,
    simulated: SimulatedParts | None = None,
    interface: InterfaceSettings = USUAL_SETTINGS,
    worker: Worker | None = None,
) -> FastAPI:
    """Return the application; it starts no task and no process.

    Whoever serves it calls `prepare` before, and `close_workers` after; its lifespan does the
    second. What takes long is done by a worker process; simulations have a further one, since they
    may take a minute, and a task that is posted meanwhile must not wait; so have replays of moments
    of the record. Each is started with the first work for it, which so takes half a second longer;
    a robot that is only watched has none.

    Args:
        supervisor: What is served.
        allowed_hosts: Names by which this service may be asked, beside those of loopback.
        allowed_origins: Whose pages may use it, beside its own; None: no others.
        access: Whom it lets in; None: everybody.
        limits: How much may be asked of it.
        simulated: What a simulation can go on with a copy of; None: the robot is real.
        interface: What is offered to clients of rosbridge.
        worker: Of `make_worker`; it is closed with the others. None: a new one.
    """
    worker = worker or make_worker()
    app = create_robot_app(supervisor, worker, access=access, limits=limits, lifespan=_lifespan)
    app.state.simulator = Worker(deadline_s=SIMULATION_DEADLINE_S)
    app.state.replayer = Worker([frame_jobs.__name__], deadline_s=REPLAY_DEADLINE_S)
    app.state.rosbridge_clients = make_rosbridge_clients(
        supervisor, interface, worker, limits.requests_per_s, app.state.stream_server
    )
    app.state.simulated = simulated
    app.state.copying = asyncio.Lock()
    app.include_router(simulations.router)
    app.include_router(frames_route.router)
    app.include_router(documents.router)
    app.include_router(rosbridge.router)
    _guard(app, supervisor, allowed_hosts, allowed_origins or AllowedOrigins())
    return app


def make_worker() -> Worker:
    """Return what does the work on models and waypoints; its process starts with the first job."""
    return Worker([model_jobs.__name__, task_jobs.__name__])


def _guard(
    app: FastAPI, supervisor: Supervisor, allowed_hosts: Sequence[str], origins: AllowedOrigins
) -> None:
    """Put the gates before the application; of these lines, the last is what a request meets first.

    Who asks too often is turned away before anything is done for it, and before tokens are tried.
    """
    state = app.state
    refusals, clock, per_s = state.refusals, supervisor.clock, state.limits.requests_per_s
    policies = RoutePolicies(app.routes)
    app.add_middleware(Audit, record=supervisor.submit, policies=policies)
    app.add_middleware(TokenGate, access=state.access, policies=policies, refusals=refusals)
    app.add_middleware(
        OriginGate,
        allowed_hosts=allowed_hosts,
        refusals=refusals,
        origins=origins,
        policies=policies,
        access=state.access,
    )
    app.add_middleware(RateGate, per_s=per_s, clock=clock, policies=policies, refusals=refusals)
    app.add_middleware(TargetGate, refusals=refusals)
    app.add_middleware(CorsHeaders, allowed=origins)
    app.add_middleware(SecurityHeaders)
    app.add_middleware(Ending)


async def prepare(app: FastAPI) -> None:
    """Build what else would be built at the first requests: the page, and the documents.

    The documents are made in forked processes: as objects they take 5 MB for as long as the service
    runs, and as text a tenth of that. The page is put together meanwhile, in the thread of the
    loop, which has nothing else to do yet: what the texts take while they are worked on would stay
    with another thread, where nothing uses it again.
    """
    async with asyncio.TaskGroup() as preparing:
        described = preparing.create_task(_made_apart(partial(encode_description, app)))
        stream = preparing.create_task(_made_apart(stream_document))
        # They are forked now.
        await asyncio.sleep(0)
        assembled_page()
    keep_description(app, described.result())
    keep_stream_description(app, stream.result())


async def _made_apart(make: Callable[[], bytes]) -> bytes:
    try:
        return await forked_call(make)
    except (OSError, ForkedCallError):
        return make()


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    try:
        yield
    finally:
        await close_workers(app)


async def close_workers(app: FastAPI) -> None:
    """End the processes that work for `app`; what they are at fails."""
    await app.state.worker.close()
    await app.state.simulator.close()
    await app.state.replayer.close()
