"""What a simulated robot remembers over a restart, as the journal keeps it.

Nodes and vehicle are kept apart: a vehicle that drives changes all the time, and there may be
thousands of nodes.
"""

from collections.abc import Mapping
from typing import cast

from domain.simulation.memory import plain_vehicle
from domain.simulation.robot import SimulatedRobot
from domain.timebase import seconds
from service.keeper import Memory
from service.storage.journal import Found, Plain

NODES, VEHICLE = "simulated_nodes", "simulated_vehicle"

_MANY_NODES = 500
_EVERY_OF_MANY = seconds(1.0)
"""To gather the states of 10,000 nodes takes some 5 ms."""
_EVERY_OF_VEHICLE = seconds(0.25)


def memories_of(robot: SimulatedRobot) -> tuple[Memory, ...]:
    """Return what is kept of a simulated robot.

    Few nodes are kept with the step that tells what they are in: one that was seen inactive must
    not be found active.
    """
    nodes, vehicle = robot.nodes, robot.vehicle
    return (
        Memory(
            NODES,
            lambda: cast("Plain", nodes.memory()),
            lambda: nodes.revision,
            0 if nodes.count <= _MANY_NODES else _EVERY_OF_MANY,
        ),
        Memory(
            VEHICLE,
            lambda: cast("Plain", plain_vehicle(vehicle.state)),
            lambda: (vehicle.state.pose, vehicle.state.steering_angle_rad),
            _EVERY_OF_VEHICLE,
        ),
    )


def memory_in(found: Found) -> Mapping[str, Plain] | None:
    """Return the memory that an earlier run left; None: there is none."""
    own = found.own or {}
    if NODES not in own and VEHICLE not in own:
        return None
    return {"nodes": own.get(NODES, ()), "vehicle": own.get(VEHICLE)}
