"""Faults of what is simulated here, set while the service runs; by the words of scenarios."""

from collections.abc import Mapping
from typing import Protocol

from domain.parameters import Parameters
from domain.state_and_mode import PartName


class LiveFaults(Protocol):
    """The simulated nodes and the simulated vehicle of this computer."""

    @property
    def node_faults(self) -> Mapping[PartName, str | None]:
        """Return all simulated nodes with their faults; None: it has none."""
        ...

    @property
    def vehicle_fault(self) -> str | None:
        """Return the fault of the vehicle; None: it has none."""
        ...

    def set_fault(self, node: PartName, fault: str | None) -> None:
        """Inject a fault into a node; None: end it.

        Raises:
            UnknownPartError: There is no such node.
        """
        ...

    def set_parameters(self, node: PartName, values: Parameters) -> None:
        """Change parameters of a node as another program would, all or none.

        Raises:
            UnknownPartError: There is no such node.
            UnknownParameterError: It has no such parameter.
            InvalidValueError: A value does not have the type of its parameter.
            RefusedError: The node is not running.
        """
        ...

    def set_vehicle_fault(self, fault: str | None) -> None:
        """Inject a fault into the vehicle; None: end it."""
        ...
