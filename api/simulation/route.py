"""Simulations: the live core runs a scenario in virtual time."""

from typing import Annotated

from fastapi import APIRouter, Depends, Request, Response

from api.http.dependencies import SupervisorDep
from api.http.request_body import limits_of, read_body
from api.http.route_policy import Permission, policy
from api.http.schemas.simulation import SimulationJson
from api.simulation.simulation_job import (
    LiveCopy,
    SimulatedParts,
    copy_of,
    simulate_posted,
)
from service.supervisor import Supervisor
from service.worker import Jobs

router = APIRouter(prefix="/simulations", tags=["simulation"])

MAX_COPIED_PARTS = 2_000
"""Of the live robot; such a copy takes 50 ms, in which nothing is supervised."""


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
    # A copy takes time on the event loop: only if the job will be taken and may request it.
    simulator.require_room()
    live = _copy(request.app.state.simulated, supervisor) if b'"live"' in raw else None
    content = await simulator.call(simulate_posted, raw, supervisor.model_text, live)
    return Response(content, media_type="application/json")


def _copy(robot: SimulatedParts | None, supervisor: Supervisor) -> LiveCopy | str | None:
    """Return a copy of one moment, so all of it in one turn of the loop; or why there is none."""
    if robot is None:
        return None
    parts = len(supervisor.model.parts)
    if parts > MAX_COPIED_PARTS:
        return (
            f"the live robot has {parts} parts: with more than {MAX_COPIED_PARTS}, a copy would "
            "hold up its supervision; begin without `from`"
        )
    clock = supervisor.clock
    now = clock.now()
    return LiveCopy(copy_of(*robot), now, clock.wall_time(now), supervisor.events.newest)
