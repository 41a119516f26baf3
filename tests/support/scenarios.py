"""Scenarios that happen in the process of the test."""

from typing import Any

from pydantic_core import from_json

from api.http.schemas.simulation import SimulationBody
from api.simulation.simulation import Simulation
from api.simulation.simulation_job import robot_for
from service.simulation.virtual_time import VirtualService
from tests.support.good import GOOD
from tests.support.http_robot import ACTUATION

Step = dict[str, Any]

ALL_GOOD: Step = {"t_s": 0, "reading": dict(GOOD)}
NEVER_STALE = {"signals": {"stale_after_s": 0}}
STRAIGHT = [{"x_m": float(x), "y_m": 0.0, "yaw_rad": 0.0} for x in range(21)]
"""Waypoints of 20 m along the x axis."""


def scenario(*steps: Step, until_s: float = 10, **more: Any) -> SimulationBody:  # noqa: ANN401
    """Return a scenario whose readings never become stale, unless `robot` says otherwise."""
    robot = None if "begin" in more else NEVER_STALE
    body = {"robot": robot, "until_s": until_s, "steps": list(steps), **more}
    return SimulationBody.model_validate(body)


def virtual_robot(body: SimulationBody) -> VirtualService:
    """Return the robot that a scenario begins with: that of Annex 4 unless it names another."""
    return robot_for(body, ACTUATION, None)


def happened(*steps: Step, until_s: float = 10, **more: Any) -> Simulation:  # noqa: ANN401
    """Return a simulation of the robot of Annex 4 after it ran."""
    body = scenario(*steps, until_s=until_s, **more)
    simulation = Simulation(body, virtual_robot(body))
    simulation.run()
    return simulation


def answer(simulation: Simulation) -> Any:  # noqa: ANN401
    """Return what a client would read."""
    return from_json(simulation.as_json())
