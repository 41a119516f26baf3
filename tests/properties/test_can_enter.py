"""What `can_enter` says of a mode is what a request for it is answered with at that moment.

Over HTTP, with robots of many shapes and in all sorts of trouble.
"""

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any, TypeAlias

import hypothesis.strategies as st
from hypothesis import HealthCheck, given, settings

from api.http.limits import ServiceLimits
from domain.lifecycle import Transition
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.simulation.node_settings import Fault, NodeSettings
from domain.state_and_mode import PartName
from domain.timebase import seconds
from tests.support.http_robot import HttpRobot, http_robot
from tests.support.models import nested_model
from tests.support.random_models import model_text, models

Trouble: TypeAlias = Callable[[HttpRobot], Coroutine[Any, Any, None]]

NAMES = {"n0": "left/arm", "n1": "left/arm/wrist", "n2": "arm", "n3": "Arm"}
"""Names that begin, end or differ only in case like another one."""
LIMITS = ServiceLimits(requests_per_s=1_000_000)


def renamed(model: SmhModel) -> SmhModel:
    """Return a model whose nodes have names that are alike."""

    def name(part: PartName) -> PartName:
        return PartName(NAMES.get(part, part))

    nodes = {name(n): NodeModel(name(n), node.modes) for n, node in model.nodes.items()}
    systems = {
        s: SystemModel(
            s, {m: {name(p): w for p, w in want.items()} for m, want in of.modes.items()}
        )
        for s, of in model.systems.items()
    }
    return SmhModel(nodes, systems)


def path(robot: HttpRobot, part: PartName) -> str:
    """Return where a part is."""
    return f"/{'systems' if part in robot.supervisor.model.systems else 'nodes'}/{part}"


# --- trouble -------------------------------------------------------------------------------------


def fault(node: PartName, what: Fault | None) -> Trouble:
    async def break_or_mend(robot: HttpRobot) -> None:
        robot.backend.set_fault(node, what)

    return break_or_mend


def ask(part: PartName, transition: Transition) -> Trouble:
    async def change(robot: HttpRobot) -> None:
        await robot.http.post(f"{path(robot, part)}/state", json={"transition": transition})

    return change


def stop(engaged: bool) -> Trouble:
    async def press_or_release(robot: HttpRobot) -> None:
        body = {"engaged": engaged, "reason": "test"}
        await robot.http.put("/emergency_stop", json=body)

    return press_or_release


def read(estop: bool) -> Trouble:
    async def press_or_release(robot: HttpRobot) -> None:
        await robot.http.post("/signals/estop", json={"value": estop})

    return press_or_release


def wait(for_s: float) -> Trouble:
    async def pass_time(robot: HttpRobot) -> None:
        await robot.pass_time(for_s)

    return pass_time


def stall(for_s: float) -> Trouble:
    async def fall_behind(robot: HttpRobot) -> None:
        robot.clock.stall(for_s)

    return fall_behind


def troubles(model: SmhModel) -> st.SearchStrategy[Trouble]:
    """Return what may happen to a robot of this model."""
    nodes = st.sampled_from(list(model.nodes))
    return st.one_of(
        st.builds(fault, nodes, st.sampled_from([None, *Fault])),
        st.builds(ask, st.sampled_from(model.parts), st.sampled_from(Transition)),
        st.builds(stop, st.booleans()),
        st.builds(read, st.booleans()),
        st.builds(wait, st.sampled_from([0.02, 0.19, 0.3, 1.0, 4.0])),
        st.builds(stall, st.sampled_from([0.02, 0.21, 1.5])),
    )


# --- the property --------------------------------------------------------------------------------


async def compare(robot: HttpRobot, part: PartName) -> None:
    """Ask for every mode of a part, each time after what is said of it at that moment."""
    at = path(robot, part)
    for mode in robot.supervisor.model.modes_of(part):
        planned = await robot.http.post(
            f"{at}/mode", json={"mode": mode}, params={"dry_run": "true"}
        )
        shown = {item["mode"]: item for item in (await robot.get(f"{at}/modes"))["items"]}[mode]
        answer = await robot.http.post(f"{at}/mode", json={"mode": mode})
        said = shown["can_enter"]
        assert said is answer.is_success, f"{part} {mode}: {said}, {answer.text}"
        assert said is planned.is_success, f"{part} {mode}: {said}, {planned.text}"
        refusing = [blocker for blocker in shown["blockers"] if blocker["refuses"]]
        assert bool(refusing) is not said
        if not said:
            assert answer.json()["blockers"] == shown["blockers"]


@st.composite
def stories(draw: st.DrawFn) -> tuple[SmhModel, list[tuple[Trouble, PartName]]]:
    """Return a model, and what happens to its robot, each time with a part to look at then."""
    model = draw(st.one_of(models().map(renamed), st.just(nested_model())))
    steps = st.tuples(troubles(model), st.sampled_from(model.parts))
    return model, draw(st.lists(steps, min_size=1, max_size=8))


@settings(max_examples=40, suppress_health_check=list(HealthCheck), deadline=None)
@given(stories())
def test_a_mode_can_be_entered_exactly_when_a_request_for_it_is_taken(
    story: tuple[SmhModel, list[tuple[Trouble, PartName]]],
) -> None:
    model, steps = story
    slow = NodeSettings(process_error=seconds(2))

    async def live() -> None:
        nodes = dict.fromkeys(model.nodes, slow)
        async with http_robot(model_text(model), limits=LIMITS, nodes=nodes) as robot:
            for happen, part in steps:
                await happen(robot)
                await compare(robot, part)

    asyncio.run(live())
