"""The supervisor of the example robot, as it is live, on a clock that a test moves."""

import asyncio
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager

from domain.findings import Finding
from domain.navigation import Navigation, NavigationSettings
from domain.onboard import Onboard
from domain.parts.system_model import SmhModel
from domain.simulation.robot import SimulatedRobot
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import Instant
from service.clock import Clock
from service.event_log import EventLog
from service.files.model_file import LoadedModel
from service.keeper import Stores
from service.simulation.remembering import memories_of
from service.simulation.simulated import SimulatedBackend
from service.storage.journal import Journal
from service.storage.trends.trends import Trends
from service.supervisor import Supervisor
from tests.support.manual_clock import ManualClock
from tests.support.models import actuation_model
from tests.support.waiting import until


def make_supervisor(
    clock: Clock | None = None,
    model: SmhModel | None = None,
    warnings: Sequence[Finding] = (),
    *,
    mock: bool = True,
    events: EventLog | None = None,
    journal: Journal | None = None,
) -> Supervisor:
    """Return a supervisor of simulated nodes that does not run yet."""
    robot = make_live_robot(clock, model, warnings, mock=mock, events=events, journal=journal)
    return robot[0]


def make_live_robot(
    clock: Clock | None = None,
    model: SmhModel | None = None,
    warnings: Sequence[Finding] = (),
    *,
    mock: bool = True,
    events: EventLog | None = None,
    journal: Journal | None = None,
    trends: Trends | None = None,
) -> tuple[Supervisor, SimulatedBackend]:
    """Return a supervisor that does not run yet, and the simulated robot that it supervises."""
    clock = clock or ManualClock()
    model = model or actuation_model()
    now = clock.now()
    robot = SimulatedRobot(model, now, mock=mock)
    backend = SimulatedBackend(robot, clock)
    supervisor = Supervisor(
        LoadedModel(model=model, warnings=tuple(warnings), text=""),
        make_onboard(model, now),
        clock,
        backend,
        backend.readings,
        simulated=robot.what,
        events=events,
        stores=Stores(journal, trends, memories_of(robot)),
    )
    return supervisor, backend


def make_onboard(
    model: SmhModel, start: Instant, settings: SupervisionSettings | None = None
) -> Onboard:
    """Return supervision and navigation with what is usual."""
    settings = settings or SupervisionSettings()
    core = Supervision(model, settings, start)
    return Onboard(core, Navigation(settings.vehicle, NavigationSettings(), core.driving.watch))


@asynccontextmanager
async def running(supervisor: Supervisor) -> AsyncIterator[None]:
    """Let a supervisor run, up to its first frame, as long as the context lasts."""
    run = asyncio.create_task(supervisor.run(), name="supervisor")
    try:
        await until(lambda: run.done() or supervisor.frames.newest is not None)
        yield
    finally:
        run.cancel()
        await asyncio.gather(run, return_exceptions=True)
