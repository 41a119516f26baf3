"""What must be true once all is well again, whatever happened before."""

from collections.abc import Iterator

from domain.computers import SUPERVISOR, ComputerName, DeviceState
from domain.inputs import EmergencyStopRequest, ModeRequest
from domain.lifecycle import LifecycleState
from domain.simulation.network import Wire
from domain.snapshot import EmergencyStopView
from domain.state_and_mode import ModeName, PartName
from domain.supervision import Supervision
from tests.support.models import ACTUATION, ARM, BASE, PERFORMANCE
from tests.support.network_world.robots import LIDAR, MODEL
from tests.support.network_world.stories import ADA, CUT, TROUBLE_S
from tests.support.network_world.world import World

WHOLE_S = 5.0
"""After which everything is known everywhere."""
LOST_AMONG_DEVICES_S = 7.5
"""After which a device gives up to hear of another one."""
PURSUED_S = 13.0
"""Within which a target is reached, also if a step whose command was lost must time out before."""
UNDER_WAY_S = 1.0
"""Within which a change is known everywhere."""
TOLD_S = 0.15
"""Within which all know of an emergency stop: one beat, and the way."""


def end(world: World) -> None:
    """Let a story happen, mend everything, and see that the robot is as it should be."""
    world.run(TROUBLE_S)
    world.make_whole()
    world.wait(WHOLE_S)
    everything_is_known(world)
    a_release_ends_all_stops(world)
    targets_are_pursued(world)
    everything_is_known(world)
    a_stop_is_known_everywhere(world)
    a_device_that_is_cut_off_does_what_it_should(world)
    everything_is_known(world)


def everything_is_known(world: World) -> None:
    """See that all are connected, and show of each node what is."""
    supervisor = world.supervisor
    for device in world.devices:
        view = supervisor.core.devices()[device.name]
        assert view.state is DeviceState.CONNECTED, f"{device.name} is {view}"
        assert view.incarnation == device.incarnation, f"{device.name} is {view}"
        assert not view.autonomous, f"{device.name} acts alone"
        status = world.oracles.orders.followed_by(device)
        assert status is not None, f"{device.name} follows nobody"
        assert status.state is DeviceState.CONNECTED, f"{device.name} says {status}"
        assert status.incarnation == supervisor.incarnation, f"{device.name} says {status}"
    # What is changed now is on its way.
    world.wait_until(lambda: not list(_shown_wrongly(world)), UNDER_WAY_S)
    wrong = list(_shown_wrongly(world))
    assert not wrong, "; ".join(wrong)


def _shown_wrongly(world: World) -> Iterator[str]:
    """Yield what somebody shows of a node and is not so."""
    for node in MODEL.nodes:
        computer = world.owner(node)
        for process in {world.process(computer.name), world.supervisor}:
            nodes, view = computer.nodes, process.core.part(node)
            where = f"{node} at {process.name}"
            if not view.reachable:
                yield f"{where} is not reachable"
            if view.actual.state is not nodes.state_of(node):
                yield f"{where} is {nodes.state_of(node)}, and not as in {view}"
            if _parameters(process.core, node) != nodes.parameters_of(node):
                yield f"{where} has other parameters"


def _parameters(core: Supervision, node: PartName) -> dict[str, object]:
    return {view.name: view.value for view in core.parameters(node)}


def a_release_ends_all_stops(world: World) -> None:
    """Release at the supervisor all that it sees.

    A stop of a process that is gone, and of which the one in its place knows nothing, is ended by
    name wherever it is known: nobody can tell on its behalf that it is over.
    """
    world.ask(SUPERVISOR, EmergencyStopRequest(False, "all clear", ADA))
    world.wait_until(lambda: not _stopped(world), 1.0)
    view = world.supervisor.core.emergency_stop()
    assert not view.engaged, f"the supervisor is stopped: {view}"
    world.wait_until(lambda: not _stopped(world), LOST_AMONG_DEVICES_S)
    for name, view in _stopped(world).items():
        left = {stop.id for stop in view.stops} - world.oracles.stops.forgotten
        assert not left, f"{name} is stopped: {view}"
        world.ask(name, EmergencyStopRequest(False, "the other one is gone", ADA))
    world.wait_until(lambda: not _stopped(world), 1.0)
    assert not _stopped(world), f"stopped are {_stopped(world)}"


def _stopped(world: World) -> dict[ComputerName, EmergencyStopView]:
    views = {p.name: p.core.emergency_stop() for _, p in world.running}
    return {name: view for name, view in views.items() if view.engaged}


def targets_are_pursued(world: World) -> None:
    """Ask for a mode of all, and see it reached."""
    for part, mode in ((ACTUATION, PERFORMANCE), (LIDAR, ModeName("WIDE"))):
        refusal = world.ask(SUPERVISOR, ModeRequest(part, mode, ADA))
        assert refusal is None, f"{part} was refused {mode}: {refusal}"
    core = world.supervisor.core
    world.wait_until(lambda: _is_at_rest(core), PURSUED_S)
    world.wait(0.25)
    for node in MODEL.nodes:
        state = world.owner(node).nodes.state_of(node)
        assert state is LifecycleState.ACTIVE, f"{node} is {state}, and was asked to be active"
        assert core.part(node).converged, f"{node} is not where its target says"
    assert world.owner(BASE).nodes.parameters_of(BASE)["max_speed"] == 0.9
    assert world.owner(ARM).nodes.parameters_of(ARM)["max_torque"] == 0.2


def _is_at_rest(core: Supervision) -> bool:
    """Tell whether all parts are where their targets say, and nothing is changed any more."""
    is_changing = any(not change.status.is_final for change in core.changes())
    return not is_changing and all(core.part(part).converged for part in MODEL.parts)


def a_stop_is_known_everywhere(world: World) -> None:
    """Press a stop somewhere, see it everywhere at once, and release it."""
    where = world.rng.choice(list(world.computers))
    world.ask(where, EmergencyStopRequest(True, "a cat", ADA))
    world.wait(TOLD_S)
    for _, process in world.running:
        assert process.core.emergency_stop().engaged, f"{process.name} knows of no stop at {where}"
    a_release_ends_all_stops(world)


def a_device_that_is_cut_off_does_what_it_should(world: World) -> None:
    """Cut a device off for long, and let it return: it does what its `offline` block says."""
    name = world.rng.choice(list(world.story.arrangement.devices))
    offline = world.story.arrangement.devices[name].offline
    before = {node: world.owner(node).nodes.state_of(node) for node in MODEL.nodes}
    set_all_wires(world, name, CUT)
    world.wait(4.0)
    for node, was in before.items():
        wanted = offline.targets[node].state if node in offline.targets else was
        state = world.owner(node).nodes.state_of(node)
        assert state is wanted, f"{node} is {state} while {name} is cut off"
        shown = world.supervisor.core.part(node)
        assert shown.reachable is (node not in world.computers[name].node_names), f"{shown}"
    set_all_wires(world, name, world.story.wire)
    world.wait(WHOLE_S)
    for node in offline.targets:
        state = world.owner(node).nodes.state_of(node)
        is_restored = node in world.story.arrangement.restored
        assert (state is before[node]) is is_restored, f"{node} is {state} after {name} is back"
        assert world.supervisor.core.part(node).converged is is_restored


def set_all_wires(world: World, name: ComputerName, wire: Wire) -> None:
    """Let all wires from and to a computer be so."""
    for other in world.computers:
        if other != name:
            world.network.set_wire(world.now, name, other, wire)
            world.network.set_wire(world.now, other, name, wire)
