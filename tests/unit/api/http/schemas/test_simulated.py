"""What is sent to give simulated parts a fault."""

import pytest
from pydantic import ValidationError

from api.http.schemas.simulated import NodeFaultBody, VehicleFaultBody, fault_of
from domain.simulation.node_settings import Fault
from domain.simulation.vehicle_settings import VehicleFault


@pytest.mark.parametrize("fault", Fault)
def test_each_fault_of_a_node_can_be_set(fault: Fault) -> None:
    assert fault_of(NodeFaultBody(fault=fault.value).fault) == fault


@pytest.mark.parametrize("fault", VehicleFault)
def test_each_fault_of_the_vehicle_can_be_set(fault: VehicleFault) -> None:
    assert fault_of(VehicleFaultBody(fault=fault.value).fault) == fault


def test_recover_ends_a_fault() -> None:
    assert fault_of("recover") is None


@pytest.mark.parametrize("body", [{}, {"fault": "die", "parameters": {"max_speed": 1.0}}])
def test_a_node_gets_a_fault_or_parameters(body: dict[str, object]) -> None:
    with pytest.raises(ValidationError, match="either a fault or parameters"):
        NodeFaultBody.model_validate(body)
