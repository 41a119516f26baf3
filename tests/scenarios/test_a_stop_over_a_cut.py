"""A stop that is engaged at a device while it is cut off stops the robot after the cut."""

from domain.computers import SUPERVISOR, ComputerName
from domain.errors import PilothouseError
from domain.inputs import EmergencyStopRequest, ModeRequest
from tests.support.models import ARM, BASE, STRONG
from tests.support.network_world.endings import set_all_wires
from tests.support.network_world.happenings import Start
from tests.support.network_world.robots import ARRANGEMENTS
from tests.support.network_world.stories import ADA, CUT, Story
from tests.support.network_world.world import World

DEVICE = ComputerName("arm")


def _cut_off() -> World:
    """Return a robot whose arm was just cut off."""
    starts = tuple((0.0, Start(name)) for name in (SUPERVISOR, ComputerName("base"), DEVICE))
    world = World(Story(0, ARRANGEMENTS[0], starts))
    world.run(1.0)
    set_all_wires(world, DEVICE, CUT)
    return world


def _is_stopped(world: World, name: ComputerName) -> bool:
    return world.process(name).core.emergency_stop().engaged


def _ask_for_strong(world: World) -> PilothouseError | None:
    return world.ask(SUPERVISOR, ModeRequest(ARM, STRONG, ADA))


def test_after_the_cut_the_robot_is_stopped_until_the_stop_of_the_device_is_released() -> None:
    world = _cut_off()
    world.ask(DEVICE, EmergencyStopRequest(True, "a hand", ADA))
    world.ask(SUPERVISOR, EmergencyStopRequest(True, "smoke", ADA))
    world.wait(3.0)
    world.ask(SUPERVISOR, EmergencyStopRequest(False, "no smoke", ADA))
    assert not _is_stopped(world, SUPERVISOR)
    assert _is_stopped(world, DEVICE)

    set_all_wires(world, DEVICE, world.story.wire)
    world.wait(2.0)
    assert all(_is_stopped(world, name) for name in world.computers)
    assert _ask_for_strong(world) is not None

    world.ask(SUPERVISOR, EmergencyStopRequest(False, "no hand", ADA))
    world.wait(1.0)
    assert not any(_is_stopped(world, name) for name in world.computers)
    assert _ask_for_strong(world) is None


def test_a_device_that_is_cut_off_does_not_know_of_a_stop_and_nothing_is_shown_as_well() -> None:
    world = _cut_off()
    world.ask(SUPERVISOR, EmergencyStopRequest(True, "smoke", ADA))
    world.wait(2.0)

    assert DEVICE in world.supervisor.core.emergency_stop().not_heard
    assert not world.supervisor.core.part(ARM).reachable
    assert world.supervisor.core.part(BASE).reachable
