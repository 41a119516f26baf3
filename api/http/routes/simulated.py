"""Faults of what is simulated, set while it runs; 409 for what is real, or on another computer."""

from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Path

from api.http.body_parsing import InvalidBodyError
from api.http.dependencies import SupervisorDep
from api.http.problems import HttpError
from api.http.request_body import JsonRoute
from api.http.route_policy import Permission, policy
from api.http.schemas.simulated import (
    NodeFaultBody,
    SimulatedJson,
    SimulatedNodeJson,
    SimulatedVehicleJson,
    VehicleFaultBody,
    fault_of,
)
from domain.errors import InvalidValueError, UnknownParameterError, UnknownPartError
from domain.state_and_mode import PartName, part_name
from service.live_faults import LiveFaults
from service.supervisor import Supervisor

router = APIRouter(prefix="/simulated", tags=["simulation"], route_class=JsonRoute)

NodePath = Annotated[str, Path(description="Name as in the model file; it may contain slashes")]


@router.get("")
@policy(Permission.OBSERVE)
async def get_simulated(supervisor: SupervisorDep) -> SimulatedJson:
    """Show the simulated nodes and the simulated vehicle, with their faults."""
    faults = supervisor.live_faults
    if faults is None:
        return SimulatedJson(nodes=[], vehicle=None)
    nodes = [SimulatedNodeJson(node=node, fault=own) for node, own in faults.node_faults.items()]
    vehicle = SimulatedVehicleJson(fault=faults.vehicle_fault)
    return SimulatedJson(nodes=nodes, vehicle=vehicle if _has_vehicle(supervisor) else None)


@router.patch("/nodes/{node:path}")
@policy(Permission.OPERATE)
async def change_simulated_node(
    node: NodePath, body: NodeFaultBody, supervisor: SupervisorDep
) -> SimulatedNodeJson:
    """Give a simulated node a fault, end it, or set its parameters from outside.

    A fault lasts until it is replaced, until `recover`, or until the service ends.
    """
    name = part_name(node)
    faults = _of_node(supervisor, name)
    if body.parameters is None:
        faults.set_fault(name, fault_of(body.fault))
    else:
        try:
            faults.set_parameters(name, body.parameters)
        except (InvalidValueError, UnknownParameterError) as error:
            raise InvalidBodyError.at("parameters", error) from error
    return SimulatedNodeJson(node=name, fault=faults.node_faults[name])


@router.patch("/vehicle")
@policy(Permission.OPERATE)
async def change_simulated_vehicle(
    body: VehicleFaultBody, supervisor: SupervisorDep
) -> SimulatedVehicleJson:
    """Give the simulated vehicle a fault, or end it."""
    faults = supervisor.live_faults
    if faults is None or not _has_vehicle(supervisor):
        raise _not_simulated("the vehicle")
    faults.set_vehicle_fault(fault_of(body.fault))
    return SimulatedVehicleJson(fault=faults.vehicle_fault)


def _of_node(supervisor: Supervisor, node: PartName) -> LiveFaults:
    """Return who sets the faults of a node.

    Raises:
        UnknownPartError: There is no such node.
        HttpError: It is not simulated here.
    """
    known = supervisor.model.nodes
    if node in supervisor.model.systems:
        raise UnknownPartError.of_other_kind(node, "node")
    if node not in known:
        raise UnknownPartError("node", node, tuple(known))
    faults = supervisor.live_faults
    if faults is None or node not in faults.node_faults:
        raise _not_simulated(node)
    return faults


def _has_vehicle(supervisor: Supervisor) -> bool:
    return "vehicle" in supervisor.simulated


def _not_simulated(what: str) -> HttpError:
    detail = f"{what} is not simulated here: it can be given no fault"
    hint = "GET /simulated lists what is"
    return HttpError(HTTPStatus.CONFLICT, "NOT_SIMULATED", detail, hint)
