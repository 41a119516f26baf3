"""The services of a lifecycle node, for a system and for a node: `lifecycle_msgs/srv/...`.

A system is asked the same way as a node, as with `ros2 lifecycle set /actuation activate`.
"""

import logging

from domain.inputs import TransitionRequest
from domain.lifecycle import (
    PRIMARY_STATES,
    TRANSITIONS,
    LifecycleState,
    Transition,
    is_legal_request,
)
from domain.state_and_mode import PartName
from service.ros.interface.change_calls import carry_out
from service.ros.interface.messages import state, transition_description
from service.ros.interface.offer import OWN_NODE, Fields, OfferedService
from service.ros.interface.shapes import CHANGE_STATE, EMPTY, checked
from service.supervisor import Supervisor

log = logging.getLogger(__name__)

_BY_ID = {rule.id: rule.transition for rule in TRANSITIONS}
_BY_LABEL = {str(value): value for value in Transition}


class LifecycleServices:
    """Those of one part."""

    def __init__(self, supervisor: Supervisor, part: PartName) -> None:
        self._supervisor = supervisor
        self._part = part

    def offered(self) -> tuple[OfferedService, ...]:
        """Return the services; a node in a ROS graph has them itself."""
        is_node = self._part in self._supervisor.model.nodes
        calls = {
            "get_state": ("GetState", self.get_state),
            "get_available_states": ("GetAvailableStates", self.get_available_states),
            "get_available_transitions": (
                "GetAvailableTransitions",
                self.get_available_transitions,
            ),
            "get_transition_graph": ("GetAvailableTransitions", self.get_transition_graph),
            "change_state": ("ChangeState", self.change_state),
        }
        return tuple(
            OfferedService(
                name=f"/{self._part}/{name}",
                type=f"lifecycle_msgs/srv/{type_name}",
                node=OWN_NODE if is_node else self._part,
                of_a_node=is_node,
                call=call,
            )
            for name, (type_name, call) in calls.items()
        )

    async def get_state(self, request: Fields, caller: str) -> Fields:
        """Answer with the state; `unknown` (0) where it is not known, or undecidable."""
        checked(EMPTY, request)
        return {"current_state": state(self._state)}

    async def get_available_states(self, request: Fields, caller: str) -> Fields:
        """Answer with all states that there are."""
        checked(EMPTY, request)
        return {"available_states": [state(value) for value in LifecycleState]}

    async def get_available_transitions(self, request: Fields, caller: str) -> Fields:
        """Answer with what may be asked now, those included that others lead to."""
        checked(EMPTY, request)
        found = self._supervisor.core.available_transitions(self._part)
        return {
            "available_transitions": [transition_description(t, self._state) for t in found],
        }

    async def get_transition_graph(self, request: Fields, caller: str) -> Fields:
        """Answer with what may be asked from each state where a part can rest."""
        checked(EMPTY, request)
        return {
            "available_transitions": [
                transition_description(t, start)
                for start in LifecycleState
                if start in PRIMARY_STATES
                for t in Transition
                if is_legal_request(t, start) and t.goal is not start
            ],
        }

    async def change_state(self, request: Fields, caller: str) -> Fields:
        """Ask for a transition: by its label, and by its number where there is no label."""
        asked = checked(CHANGE_STATE, request)["transition"]
        wanted = _transition_of(asked["label"], asked["id"])
        if wanted is None:
            what = f"{asked['label']!r:.100} [{asked['id']}] of {self._part}, asked by {caller}"
            log.info("refused %s: there is no such transition", what)
            return {"success": False}
        done = await carry_out(self._supervisor, TransitionRequest(self._part, wanted, caller))
        return {"success": done}

    @property
    def _state(self) -> LifecycleState:
        return self._supervisor.core.part(self._part).actual.state


def _transition_of(label: str, number: int) -> Transition | None:
    """Return a transition as rcl finds it: a label that is given decides alone."""
    return _BY_LABEL.get(label) if label else _BY_ID.get(number)
