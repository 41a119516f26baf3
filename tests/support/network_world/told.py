"""Tells a story, and what was wrong in it."""

import traceback

from service.codec.codec import STEPS
from service.codec.recorded_step import recorded_step
from tests.support.network_world.cores import make_core
from tests.support.network_world.endings import end
from tests.support.network_world.processes import Process, Step
from tests.support.network_world.shrinking import shortest
from tests.support.network_world.stories import Story
from tests.support.network_world.world import World


def tell(story: Story) -> World:
    """Let a story happen.

    Raises:
        AssertionError: Something was wrong; it says when, and the shortest story that shows it.
    """
    fault = fault_of(story)
    if isinstance(fault, World):
        return fault
    short = shortest(story, lambda shorter: not isinstance(fault_of(shorter), World))
    raise AssertionError(f"{fault_of(short)}\n{short}\n\nas it was told: {fault}\n{story}")


def fault_of(story: Story) -> World | str:
    """Return the world after a story, or what was wrong and when."""
    world = World(story)
    try:
        end(world)
        for process in world.oracles.runs:
            _replay(process, story)
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        at = f"at {world.now / 1e9:.3f} s, {where.filename}:{where.lineno}"
        return f"{at}: {type(error).__name__}: {error}"
    return world


def _replay(process: Process, story: Story) -> None:
    """Give a core of its own all inputs of a process again: the same follows."""
    first = process.started_at + process.at.clock_ahead
    core = make_core(process.name, story.arrangement, first)
    for number, step in enumerate(process.steps):
        again = Step(step.at, step.given, core.handle(step.given, step.at))
        if again.outputs != step.outputs:
            assert _record(again) == _record(step), f"step {number} of {process.name} differs"


def _record(step: Step) -> bytes:
    return STEPS.encode(recorded_step(step.at, step.given, False, step.outputs))
