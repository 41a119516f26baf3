"""A live service on a manual clock and a simulation, fed the same, tell the same events.

The live one runs as it does on a robot, with all its tasks; only its clock is moved by hand.
"""

import asyncio
import json
import os
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import hypothesis.strategies as st
from hypothesis import given, settings

from api.http.schemas.simulation import SimulationBody
from api.http.schemas.tasks import TaskBody
from api.http.task_jobs import task_of
from api.simulation.simulation import Simulation
from api.simulation.simulation_job import robot_for
from domain.errors import PilothouseError
from domain.simulation.node_settings import Fault
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from domain.timebase import seconds, to_seconds
from service.files.robot_settings import SignalsBlock
from tests.support.http_robot import ACTUATION, HttpRobot
from tests.support.live_robot import running
from tests.support.service_operator import ServiceOperator

EXAMPLES = 1_000 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 50
END_S = 12.0

TRACKS = {
    "straight": [(float(x), 0.0) for x in range(0, 31, 3)],
    "beside": [(float(x), 1.5) for x in range(0, 25, 2)],
    "bend": [(x / 2, (x / 2) ** 2 / 40) for x in range(50)],
    "far": [(90.0, 0.0), (100.0, 0.0)],
}

# On the grid of vehicle and mock as often as off it, since it is equal times that could differ.
TIMES = st.one_of(
    st.integers(0, 220).map(lambda n: n * 0.05), st.integers(0, 11_000).map(lambda n: n * 0.001)
)

READINGS = st.one_of(
    st.fixed_dictionaries({"estop": st.booleans()}),
    st.fixed_dictionaries({"battery_level": st.sampled_from([0.4, 0.5, 0.9])}),
    st.fixed_dictionaries({"temperature": st.sampled_from([20.0, 60.0])}),
    st.fixed_dictionaries({"signal_strength": st.sampled_from(["CONNECTED", "NOT_CONNECTED"])}),
)
STEPS = st.one_of(
    st.fixed_dictionaries({"t_s": TIMES, "reading": READINGS}),
    st.fixed_dictionaries(
        {
            "t_s": TIMES,
            "task": st.fixed_dictionaries(
                {
                    "waypoints": st.sampled_from(sorted(TRACKS)).map(
                        lambda name: [{"x_m": x, "y_m": y, "yaw_rad": 0.0} for x, y in TRACKS[name]]
                    ),
                    "controller": st.sampled_from(["pure_pursuit", "stanley"]),
                    "speed_mps": st.sampled_from([1.0, 2.8, 7.0]),
                }
            ),
        }
    ),
    st.fixed_dictionaries({"t_s": TIMES, "task": st.none()}),
    st.fixed_dictionaries(
        {
            "t_s": TIMES,
            "change": st.one_of(
                st.fixed_dictionaries(
                    {
                        "part": st.just("actuation"),
                        "mode": st.sampled_from(["__DEFAULT__", "MODERATE", "PERFORMANCE"]),
                    }
                ),
                st.fixed_dictionaries(
                    {
                        "part": st.sampled_from(["drive_base", "manipulator", "actuation"]),
                        "transition": st.sampled_from(["configure", "activate", "deactivate"]),
                    }
                ),
            ),
        }
    ),
    st.fixed_dictionaries(
        {
            "t_s": TIMES,
            "node": st.sampled_from(["drive_base", "manipulator"]),
            "fault": st.sampled_from(["silent", "refuse", "error", "die", "recover"]),
        }
    ),
    st.fixed_dictionaries({"t_s": TIMES, "vehicle": st.sampled_from(["silent", "recover"])}),
    st.fixed_dictionaries({"t_s": TIMES, "hold": st.booleans()}),
    st.fixed_dictionaries({"t_s": TIMES, "stop": st.booleans()}),
)
SCENARIOS = st.lists(STEPS, max_size=14).map(lambda steps: sorted(steps, key=lambda s: s["t_s"]))

NEVER_STALE = SupervisionSettings(SignalsBlock(stale_after_s=0.0).to_domain())

Told = list[tuple[float, str, int | None, dict[str, Any]]]


def told_by(events: Sequence[Any]) -> Told:
    """Return what events say, actors and wall times aside."""
    return [
        (
            to_seconds(event.at),
            event.kind,
            event.cause,
            json.loads(json.dumps(dict(event.data), default=str)),
        )
        for event in events
    ]


def simulated(steps: Sequence[dict[str, Any]], mock: bool) -> Told:
    """Return the events of a simulation."""
    body = SimulationBody.model_validate(
        {
            "model": ACTUATION,
            # Without the mock most signals are never read: staleness off, so that it can drive.
            "robot": {"mock": True} if mock else {"signals": {"stale_after_s": 0}},
            "until_s": END_S,
            "sample_period_s": END_S,
            "steps": [_as_posted(step) for step in steps],
        }
    )
    robot = robot_for(body, "", None)
    Simulation(body, robot).run()
    return told_by(list(robot.supervisor.events.oldest_first()))


def _as_posted(step: dict[str, Any]) -> dict[str, Any]:
    """Return a step as a scenario has it: holds and stops are requests there."""
    if "hold" in step:
        method = "PUT" if step["hold"] else "DELETE"
        asked = {"method": method, "path": "/holds/operator", "body": {"reason": "test"}}
        return {"t_s": step["t_s"], "request": asked}
    if "stop" in step:
        body = {"engaged": step["stop"], "reason": "test"}
        asked = {"method": "PUT", "path": "/emergency_stop", "body": body}
        return {"t_s": step["t_s"], "request": asked}
    return step


async def live(steps: Sequence[dict[str, Any]], mock: bool) -> Told:
    """Return the events of the live service."""
    robot = HttpRobot(mock=mock, settings=None if mock else NEVER_STALE)
    async with running(robot.supervisor):
        for step in steps:
            await robot.clock.advance_to(seconds(step["t_s"]))
            with suppress(PilothouseError):
                _act(robot, step)
            await robot.clock.advance(0)
        await robot.clock.advance_to(seconds(END_S))
    await robot.http.aclose()
    return told_by(list(robot.supervisor.events.oldest_first()))


def _act(robot: HttpRobot, step: dict[str, Any]) -> None:
    operator = ServiceOperator(robot.supervisor, robot.clock)
    match step:
        case {"reading": values}:
            operator.read(**values)
        case {"task": None}:
            operator.cancel_task()
        case {"task": posted}:
            task = task_of(TaskBody.model_validate(posted))
            operator.submit_task(
                task.path,
                start_index=task.start_index,
                controller=task.controller,
                speed_mps=task.speed_mps,
            )
        case {"change": {"part": part, "mode": mode}}:
            operator.ask_mode(part, mode)
        case {"change": {"part": part, "transition": transition}}:
            operator.ask_transition(part, transition)
        case {"node": node, "fault": fault}:
            recovers = fault == "recover"
            robot.backend.set_fault(PartName(node), None if recovers else Fault(fault))
        case {"vehicle": fault}:
            robot.backend.set_vehicle_fault(None if fault == "recover" else fault)
        case {"hold": True}:
            operator.hold(reason="test")
        case {"hold": False}:
            operator.release()
        case {"stop": True}:
            operator.stop()
        case {"stop": False}:
            operator.release_stop()
        case _:
            raise NotImplementedError(step)


@settings(max_examples=EXAMPLES)
@given(SCENARIOS, st.booleans())
def test_a_simulation_tells_what_the_live_service_tells(
    steps: list[dict[str, Any]], mock: bool
) -> None:
    assert simulated(steps, mock) == asyncio.run(live(steps, mock))


@settings(max_examples=EXAMPLES // 5)
@given(SCENARIOS, st.booleans())
def test_two_simulations_tell_the_same(steps: list[dict[str, Any]], mock: bool) -> None:
    assert simulated(steps, mock) == simulated(steps, mock)
