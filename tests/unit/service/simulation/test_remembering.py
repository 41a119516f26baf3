"""A simulated robot is where it was, also after its simulator ended."""

from domain.inputs import Restored
from domain.simulation.robot import SimulatedRobot
from domain.timebase import seconds
from service.simulation.remembering import NODES, VEHICLE, memories_of, memory_in
from service.storage.journal import Found, Plain
from tests.support.big_model import big_model
from tests.support.models import BASE, actuation_model


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


def test_thousands_of_nodes_are_gathered_less_often() -> None:
    nodes, vehicle = memories_of(SimulatedRobot(big_model(600), 0))

    assert (nodes.name, vehicle.name) == (NODES, VEHICLE)
    assert nodes.every > vehicle.every
