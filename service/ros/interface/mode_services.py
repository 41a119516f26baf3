"""The services that the mode manager of D4.8 has for each part: `system_modes_msgs/srv/...`."""

from domain.inputs import ModeRequest
from domain.lifecycle import LifecycleState
from domain.state_and_mode import PartName
from service.ros.interface.change_calls import carry_out
from service.ros.interface.offer import OWN_NODE, Fields, OfferedService
from service.ros.interface.shapes import CHANGE_MODE, EMPTY, checked
from service.supervisor import Supervisor

UNKNOWN_MODE = "unknown"
"""What `get_mode` answers for a part of which even the state is not known."""


class ModeServices:
    """Those of one part. The node itself has none of them, and so they are always offered."""

    def __init__(self, supervisor: Supervisor, part: PartName) -> None:
        self._supervisor = supervisor
        self._part = part

    def offered(self) -> tuple[OfferedService, ...]:
        """Return the services."""
        calls = {
            "get_mode": ("GetMode", self.get_mode),
            "change_mode": ("ChangeMode", self.change_mode),
            "get_available_modes": ("GetAvailableModes", self.get_available_modes),
        }
        return tuple(
            OfferedService(
                name=f"/{self._part}/{name}",
                type=f"system_modes_msgs/srv/{type_name}",
                node=self._part if self._part in self._supervisor.model.systems else OWN_NODE,
                of_a_node=False,
                call=call,
            )
            for name, (type_name, call) in calls.items()
        )

    async def get_mode(self, request: Fields, caller: str) -> Fields:
        """Answer with the mode; empty where the part is in none, as while it is inactive.

        `unknown` says that nobody knows, as in system_modes.
        """
        checked(EMPTY, request)
        actual = self._supervisor.core.part(self._part).actual
        if actual.state is LifecycleState.UNKNOWN:
            return {"current_mode": UNKNOWN_MODE}
        return {"current_mode": actual.mode or ""}

    async def get_available_modes(self, request: Fields, caller: str) -> Fields:
        """Answer with all modes of the part, in the order of the model file."""
        checked(EMPTY, request)
        return {"available_modes": list(self._supervisor.model.modes_of(self._part))}

    async def change_mode(self, request: Fields, caller: str) -> Fields:
        """Ask for a mode; one that the part is in already is a success."""
        mode = checked(CHANGE_MODE, request)["mode_name"]
        done = await carry_out(self._supervisor, ModeRequest(self._part, mode, caller))
        return {"success": done}
