"""Targets of parts, as announced by whoever manages the modes: `*_request_info` of system_modes.

Pilothouse latches these topics, and the mode manager of system_modes does not. A subscription that
asks for what was latched hears no publisher that does not latch; so there are two per topic.
"""

import asyncio
from collections.abc import Callable, Iterable
from functools import partial

from domain.lifecycle import LifecycleState
from domain.parts.observed_parts import AnnouncedTarget
from domain.state_and_mode import ModeName, PartName, StateAndMode
from service.ros.backend.node_services import read_state
from service.ros.graph.graph import Message, Qos, RosGraph, RosNode

_TRANSITION_EVENT = "lifecycle_msgs/msg/TransitionEvent"
_MODE_EVENT = "system_modes_msgs/msg/ModeEvent"


class AnnouncedTargets:
    """Subscriptions to the announced targets of parts."""

    def __init__(self, parts: Iterable[PartName], graph: RosGraph, node: RosNode) -> None:
        """Prepare.

        Args:
            parts: The parts; their names are allowed in ROS.
            graph: The ROS 2 graph.
            node: Our node, which has the subscriptions.
        """
        self._parts = tuple(parts)
        self._graph = graph
        self._node = node

    async def start(self, deliver: Callable[[AnnouncedTarget], None]) -> None:
        """Subscribe; other tasks of the event loop run in between.

        Args:
            deliver: Gets the targets on the event loop's thread.

        Raises:
            UnknownTypeError: `lifecycle_msgs` is not installed.
        """
        has_modes = self._graph.has_type(_MODE_EVENT)
        # Without that package the service announces modes as states, and so do we expect them.
        mode_type = _MODE_EVENT if has_modes else _TRANSITION_EVENT
        pick_mode = _pick_mode if has_modes else _pick_mode_in_state
        for part in self._parts:
            # In this order: of messages that wait at the same time, rclpy takes those of the
            # earlier subscription first, and system_modes requests the mode last.
            for topic, kind, pick in (
                ("transition_request_info", _TRANSITION_EVENT, _pick_state),
                ("mode_request_info", mode_type, pick_mode),
            ):
                for qos in (Qos.LATCHED, Qos.EVENTS):
                    name = f"/{part}/{topic}"
                    self._node.subscribe(name, kind, qos, partial(pick, part), deliver)
            await asyncio.sleep(0)


def _pick_state(part: PartName, message: Message) -> AnnouncedTarget | None:
    state = read_state(message.goal_state)
    if state is LifecycleState.UNKNOWN:
        return None
    return AnnouncedTarget(part, state, stamp=int(message.timestamp))


def _pick_mode(part: PartName, message: Message) -> AnnouncedTarget | None:
    return _in_mode(part, str(message.goal_mode.label), message)


def _pick_mode_in_state(part: PartName, message: Message) -> AnnouncedTarget | None:
    """Read a label such as `active.FAST`."""
    try:
        mode = StateAndMode.parse(str(message.goal_state.label)).mode
    except ValueError:
        return None
    return _in_mode(part, mode or "", message)


def _in_mode(part: PartName, mode: str, message: Message) -> AnnouncedTarget | None:
    if not mode:
        return None
    stamp = int(message.timestamp)
    return AnnouncedTarget(part, LifecycleState.ACTIVE, ModeName(mode), stamp)
