"""Faults of simulated nodes and of the simulated vehicle."""

from typing import Literal, Self, TypeAlias

from pydantic import Field, model_validator

from api.http.schemas.base import Body, Json
from api.http.schemas.sent_values import SentParameter
from domain.state_and_mode import PartName

RECOVER = "recover"

FaultName: TypeAlias = Literal["slow", "refuse", "fail", "error", "silent", "die", "recover"]
VehicleFaultName: TypeAlias = Literal["silent", "weak_brakes", "recover"]


def fault_of(name: str | None) -> str | None:
    """Return the fault that a name sets; None: it ends the fault."""
    return None if name == RECOVER else name


class NodeFaultBody(Body):
    """Give a simulated node a fault, or set its parameters as another program would."""

    fault: FaultName | None = Field(default=None, description="`recover` ends it")
    parameters: dict[str, SentParameter] | None = None

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        if (self.fault is None) is (self.parameters is None):
            raise ValueError("expected either a fault or parameters")
        return self


class VehicleFaultBody(Body):
    """Give the simulated vehicle a fault."""

    fault: VehicleFaultName = Field(
        description="`silent`: it no longer reports its pose; `weak_brakes`: it brakes with "
        "0.3 m/s² at most; `recover` ends either"
    )


class SimulatedNodeJson(Json):
    """A simulated node, and its fault."""

    node: PartName
    fault: str | None


class SimulatedVehicleJson(Json):
    """The simulated vehicle, and its fault."""

    fault: str | None


class SimulatedJson(Json):
    """What is simulated here, and which faults it has."""

    nodes: list[SimulatedNodeJson]
    vehicle: SimulatedVehicleJson | None = Field(description="null: it is not simulated here")
