"""A simulated robot is where it was, also after its simulator ended."""

from datetime import UTC, datetime

from domain.inputs import ModeRequest, NodeReport, Restored, TransitionRequest
from domain.lifecycle import LifecycleState, Transition
from domain.simulation.memory import read_memory, rest_of
from domain.simulation.robot import SimulatedRobot
from domain.timebase import seconds
from service.simulation.remembering import NODES, VEHICLE, memories_of, memory_in
from service.storage.journal import Boot, Found, Plain, Step
from service.storage.memory import MemoryJournal, MemoryStore
from tests.support.big_model import big_model
from tests.support.live_robot import make_live_robot, running
from tests.support.manual_clock import ManualClock
from tests.support.models import BASE, FAST, actuation_model

MODEL = actuation_model()


def kept_of(robot: SimulatedRobot) -> dict[str, Plain]:
    return {memory.name: memory.value() for memory in memories_of(robot)}


def test_a_robot_goes_on_from_what_is_kept_of_it() -> None:
    robot = SimulatedRobot(actuation_model(), 0)
    robot.nodes.set_parameters(BASE, {"max_speed": 0.4}, 0)
    found = Found(Restored(), own=kept_of(robot))

    again = SimulatedRobot(actuation_model(), seconds(100), memory=memory_in(found))

    assert again.nodes.parameters_of(BASE)["max_speed"] == 0.4
    assert again.left_out == ()


def test_a_new_robot_has_no_memory() -> None:
    assert memory_in(Found(Restored())) is None
    assert memory_in(Found(Restored(), own={"last_request": [1, "HoldRequest"]})) is None


def test_what_changes_is_seen_without_gathering_it() -> None:
    robot = SimulatedRobot(actuation_model(), 0)
    nodes, vehicle = memories_of(robot)
    before = nodes.revision(), vehicle.revision()

    robot.nodes.set_parameters(BASE, {"max_speed": 0.4}, 0)

    assert nodes.revision() != before[0]
    assert vehicle.revision() == before[1]


def test_few_nodes_are_kept_with_each_step_and_thousands_less_often() -> None:
    few, _ = memories_of(SimulatedRobot(actuation_model(), 0))
    many, vehicle = memories_of(SimulatedRobot(big_model(600), 0))

    assert (many.name, vehicle.name) == (NODES, VEHICLE)
    assert few.every == 0
    assert many.every > vehicle.every


class Watching(MemoryJournal):
    """A journal that compares what a step tells of the base with what is remembered then."""

    def __init__(self, clock: ManualClock) -> None:
        self.store = MemoryStore()
        boot = Boot("epoch", "1.0", 0, datetime.now(UTC), "", "")
        super().__init__(boot, clock, self.store)
        self.seen: list[tuple[LifecycleState, LifecycleState | None]] = []

    def note(self, step: Step) -> None:
        super().note(step)
        if isinstance(step.given, NodeReport) and step.given.node == BASE and step.given.state:
            memory = read_memory(memory_in(Found(Restored(), own=self.store.own)), MODEL)
            self.seen.append((step.given.state, memory.nodes[BASE].state))


async def test_a_node_that_was_seen_inactive_is_remembered_so_in_the_same_step() -> None:
    clock = ManualClock()
    journal = Watching(clock)
    supervisor, _ = make_live_robot(clock, MODEL, journal=journal)
    async with running(supervisor):
        supervisor.submit(ModeRequest(BASE, FAST))
        await clock.advance(2)
        supervisor.submit(TransitionRequest(BASE, Transition.DEACTIVATE))
        await clock.advance(2)

    told = [told for told, _ in journal.seen]
    assert told[-2:] == [LifecycleState.DEACTIVATING, LifecycleState.INACTIVE]
    assert [remembered for _, remembered in journal.seen] == [rest_of(state) for state in told]
