"""The topics of the robot: its state at 20 Hz, as in smart_polaris, and its diagnostics."""

from domain.snapshot import SystemState, TaskStatus
from domain.timebase import Instant, seconds
from service.frame_feed import Frame, FrameFeed
from service.frame_publisher import PERIOD
from service.ros.interface.diagnostics import diagnostic_array
from service.ros.interface.endpoints import OWN_NODE, Listeners, OfferedTopic
from service.ros.interface.message_fields import header
from service.ros.interface.message_sets import MessageSet, type_in
from service.supervisor import Supervisor

SYSTEM_STATE = "/system_state"
TASK_STATUS = "/task_planner_status"
DIAGNOSTICS = "/diagnostics"

# The constants of SystemState.msg and TaskStatus.msg, which are those of smart_polaris.
_STATES = {state: number for number, state in enumerate(SystemState)}
_TASK_STATUSES = {status: number for number, status in enumerate(TaskStatus)}

_DIAGNOSTICS_PERIOD = seconds(1.0) - PERIOD // 2
"""1 s, less half a tick, since ticks may come a little early."""


class RobotTopics:
    """The topics of the robot as a whole, fed with its frames."""

    def __init__(self, supervisor: Supervisor, listeners: Listeners, messages: MessageSet) -> None:
        self._types = {
            SYSTEM_STATE: type_in(messages, "SystemState"),
            TASK_STATUS: type_in(messages, "TaskStatus"),
            DIAGNOSTICS: "diagnostic_msgs/msg/DiagnosticArray",
        }
        self._clock = supervisor.clock
        self._listeners = listeners
        self._told: int | None = None
        """Number of the last published frame."""
        self._diagnosed_at: Instant | None = None
        self._diagnosed: tuple[SystemState, tuple[str, ...]] | None = None

    def offered(self) -> tuple[OfferedTopic, ...]:
        """Return the topics."""
        return tuple(
            OfferedTopic(name, type_name, OWN_NODE, False, False, on_demand=name == DIAGNOSTICS)
            for name, type_name in self._types.items()
        )

    def take(self, frames: FrameFeed) -> None:
        """Publish the newest frame, once."""
        frame = frames.newest
        if frame is None or frame.seq == self._told:
            return
        self._told = frame.seq
        if self._listeners.hears(SYSTEM_STATE):
            view = frame.system_state
            message = {
                "header": header(self._clock, frame.at),
                "error_code": view.error_code,
                "state": _STATES[view.state],
            }
            self._listeners.send(SYSTEM_STATE, message)
        if self._listeners.hears(TASK_STATUS):
            status = _TASK_STATUSES[frame.system_state.task_status]
            message = {"header": header(self._clock, frame.at), "status": status}
            self._listeners.send(TASK_STATUS, message)
        if self._listeners.hears(DIAGNOSTICS) and self._is_diagnosis_due(frame):
            complete = frames.complete()
            if complete is not None:
                self._diagnosed_at = frame.at
                self._diagnosed = _what_matters(frame)
                self._listeners.send(DIAGNOSTICS, diagnostic_array(complete, self._clock))

    def _is_diagnosis_due(self, frame: Frame) -> bool:
        """Tell whether a second has passed, or the state or the errors have changed."""
        if self._diagnosed_at is None or _what_matters(frame) != self._diagnosed:
            return True
        return frame.at - self._diagnosed_at >= _DIAGNOSTICS_PERIOD


def _what_matters(frame: Frame) -> tuple[SystemState, tuple[str, ...]]:
    return frame.system_state.state, frame.system_state.errors
