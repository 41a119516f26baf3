"""Simulations: the live core runs a scenario in virtual time."""

from functools import partial
from typing import Annotated

from fastapi import APIRouter, Depends, Request, Response
from starlette.datastructures import State

from api.http.client_presence import while_connected
from api.http.dependencies import SupervisorDep
from api.http.request_body import limits_of, read_body
from api.http.route_policy import Permission, policy
from api.http.schemas.simulation import SimulationJson
from api.simulation.simulation_job import (
    HAS_DEVICES,
    IS_REAL,
    LiveCopy,
    SimulatedParts,
    copy_of,
    simulate_posted,
)
from service.forked_call import forked_call
from service.supervisor import Supervisor
from service.worker import Jobs, OutOfMemoryError

router = APIRouter(prefix="/simulations", tags=["simulation"])


# A coroutine, since the framework would call a plain function in a thread.
async def _simulator(request: Request) -> Jobs:
    found: Jobs = request.app.state.simulator
    return found


SimulatorDep = Annotated[Jobs, Depends(_simulator)]
"""A separate worker for simulations, so that a task that is submitted meanwhile need not wait."""


@router.post(
    "",
    response_model=SimulationJson,
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {
                "application/json": {"schema": {"$ref": "#/components/schemas/SimulationBody"}}
            },
        }
    },
)
@policy(Permission.OBSERVE)
async def simulate(
    request: Request, supervisor: SupervisorDep, simulator: SimulatorDep
) -> Response:
    """Run a scenario in virtual time and return the results; the live robot is not affected.

    Supervision, planner, navigation and simulated robot are the code that runs live. Only the
    scenario provides readings, unless `robot` has `mock: true`.
    """
    raw = await read_body(request, limits_of(request).model_bytes)
    live = await _copy(request.app.state, supervisor) if b'"live"' in raw else None
    why_not = IS_REAL if supervisor.link is None else HAS_DEVICES
    work = simulator.call(simulate_posted, raw, supervisor.model_text, live, why_not)
    # Others wait for the worker: it must not go on for somebody who has gone.
    content = await while_connected(request, work)
    return Response(content, media_type="application/json")


async def _copy(state: State, supervisor: Supervisor) -> LiveCopy | None:
    """Return a copy of the live robot as it is now; None: it is real.

    Raises:
        PilothouseError: A simulation would not be taken, or there is no memory for a copy.
    """
    robot: SimulatedParts | None = state.simulated
    if robot is None:
        return None
    async with state.copying:
        # A copy costs memory: one at a time, and only if the job will be taken.
        state.simulator.require_room()
        clock = supervisor.clock
        now, newest = clock.now(), supervisor.events.newest
        try:
            copied = await forked_call(partial(copy_of, *robot))
        except OSError as error:
            raise OutOfMemoryError from error
    return LiveCopy(copied, now, clock.wall_time(now), newest)
