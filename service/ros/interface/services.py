"""All services: those of a lifecycle node and a mode manager for each part, and of the robot."""

import logging
from functools import partial

from domain.actor import Actor
from domain.errors import PilothouseError
from domain.inputs import CancelTaskRequest, ModeRequest, TransitionRequest
from domain.lifecycle import (
    PRIMARY_STATES,
    TRANSITIONS,
    LifecycleState,
    Transition,
    is_legal_request,
)
from domain.snapshot import ChangeStatus
from domain.state_and_mode import PartName
from service.ros.interface.endpoints import OWN_NODE, Fields, OfferedService
from service.ros.interface.message_check import CHANGE_MODE, CHANGE_STATE, EMPTY, checked
from service.ros.interface.message_fields import state, transition_description
from service.supervisor import Supervisor

log = logging.getLogger(__name__)

MAX_WAIT_S = 60.0
"""Longest wait for the end of a change, s; after it the response is no success, and the change
goes on."""


async def carry_out(supervisor: Supervisor, request: ModeRequest | TransitionRequest) -> bool:
    """Start a change, wait for its end, and tell whether it succeeded.

    The reason of a failure is logged, since the response has no field for it.
    """
    wanted = request.mode if isinstance(request, ModeRequest) else str(request.transition)
    what = f"{wanted!r:.100} of {request.part}, requested by {request.actor.label}"
    try:
        change = (await supervisor.request(request)).outputs.change
        if change is None:
            raise RuntimeError(f"{request} was taken and is no change")
        view = await supervisor.change_ends.wait(change, MAX_WAIT_S)
    except PilothouseError as error:
        log.info("rejected %s: %.500s", what, error)
        return False
    if view.status is not ChangeStatus.SUCCEEDED:
        log.info("%s: change %s %s: %.500s", what, view.id, view.status, view.reason or "")
    return view.status is ChangeStatus.SUCCEEDED


_BY_ID = {rule.id: rule.transition for rule in TRANSITIONS}
_BY_LABEL = {str(value): value for value in Transition}


class LifecycleServices:
    """The services of a lifecycle node for one part: `lifecycle_msgs/srv/...`.

    A system has them as a node does, for `ros2 lifecycle set /actuation activate`.
    """

    def __init__(self, supervisor: Supervisor, part: PartName) -> None:
        self._supervisor = supervisor
        self._part = part

    def offered(self) -> tuple[OfferedService, ...]:
        """Return the services; a node in a ROS graph offers them itself."""
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
                writes=name == "change_state",
            )
            for name, (type_name, call) in calls.items()
        )

    async def get_state(self, request: Fields, caller: Actor) -> Fields:
        """Return the state; `unknown` (0) if it is unknown or undecidable."""
        checked(EMPTY, request)
        return {"current_state": state(self._state)}

    async def get_available_states(self, request: Fields, caller: Actor) -> Fields:
        """Return all lifecycle states."""
        checked(EMPTY, request)
        return {"available_states": [state(value) for value in LifecycleState]}

    async def get_available_transitions(self, request: Fields, caller: Actor) -> Fields:
        """Return the transitions that may be requested now, also those that need others first."""
        checked(EMPTY, request)
        found = self._supervisor.core.available_transitions(self._part)
        return {
            "available_transitions": [transition_description(t, self._state) for t in found],
        }

    async def get_transition_graph(self, request: Fields, caller: Actor) -> Fields:
        """Return the transitions that may be requested from each primary state."""
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

    async def change_state(self, request: Fields, caller: Actor) -> Fields:
        """Request a transition by its label, or by its id if the label is empty."""
        asked = checked(CHANGE_STATE, request)["transition"]
        wanted = _transition_of(asked["label"], asked["id"])
        if wanted is None:
            what = (
                f"{asked['label']!r:.100} [{asked['id']}] of {self._part}, "
                f"requested by {caller.label}"
            )
            log.info("rejected %s: there is no such transition", what)
            return {"success": False}
        done = await carry_out(self._supervisor, TransitionRequest(self._part, wanted, caller))
        return {"success": done}

    @property
    def _state(self) -> LifecycleState:
        return self._supervisor.core.part(self._part).actual.state


def _transition_of(label: str, number: int) -> Transition | None:
    """Find a transition as rcl does: by the label, or by the id if the label is empty."""
    return _BY_LABEL.get(label) if label else _BY_ID.get(number)


UNKNOWN_MODE = "unknown"
"""Response of `get_mode` for a part whose state is unknown."""


class ModeServices:
    """The services of the mode manager for one part: `system_modes_msgs/srv/...`.

    They are those of the micro-ROS deliverable D4.8. Nodes do not offer them themselves, and so
    they are always offered here.
    """

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
                writes=name == "change_mode",
            )
            for name, (type_name, call) in calls.items()
        )

    async def get_mode(self, request: Fields, caller: Actor) -> Fields:
        """Return the mode; empty if the part has none, for example while it is inactive.

        `unknown` if the state is unknown, as in system_modes.
        """
        checked(EMPTY, request)
        actual = self._supervisor.core.part(self._part).actual
        if actual.state is LifecycleState.UNKNOWN:
            return {"current_mode": UNKNOWN_MODE}
        return {"current_mode": actual.mode or ""}

    async def get_available_modes(self, request: Fields, caller: Actor) -> Fields:
        """Return all modes of the part, in the order of the model file."""
        checked(EMPTY, request)
        return {"available_modes": list(self._supervisor.model.modes_of(self._part))}

    async def change_mode(self, request: Fields, caller: Actor) -> Fields:
        """Request a mode; if the part is in it already, that is a success."""
        mode = checked(CHANGE_MODE, request)["mode_name"]
        done = await carry_out(self._supervisor, ModeRequest(self._part, mode, caller))
        return {"success": done}


CANCEL_TASKS = "/cancel_tasks"


def robot_services(supervisor: Supervisor) -> tuple[OfferedService, ...]:
    """Return the services of the robot as a whole."""
    cancel = OfferedService(
        name=CANCEL_TASKS,
        type="std_srvs/srv/Empty",
        node=OWN_NODE,
        of_a_node=False,
        call=partial(_cancel_tasks, supervisor),
        writes=True,
    )
    return (cancel,)


async def _cancel_tasks(supervisor: Supervisor, request: Fields, caller: Actor) -> Fields:
    """End the task, if there is one."""
    checked(EMPTY, request)
    await supervisor.request(CancelTaskRequest(caller))
    return {}
