"""Events: every kind with its meaning and its data."""

from dataclasses import dataclass

from docs.generate.markdown import code, page, table
from docs.generate.source_scan import event_kinds, require_described
from domain.snapshot import ChangeStatus, TaskPhase


@dataclass(frozen=True, slots=True)
class Kind:
    """One kind of event."""

    name: str
    about: str
    keys: tuple[str, ...] = ()
    """Of its data; a key with `?` is present only where it applies."""
    is_input: bool = False
    """It came from outside, or from the clock, and is recorded only when it has an effect."""


_ENDED = ("change", "part", "reason")
_TASK_ENDED = ("task", "reason", "progress")
_TASK_ENDS = (TaskPhase.SUCCEEDED, TaskPhase.CANCELED, TaskPhase.ABORTED)
_DEVIATION = ("part", "target", "actual", "reason")

KINDS = (
    Kind(
        "audit.write",
        "A write request was answered.",
        ("method", "path", "status", "address"),
        is_input=True,
    ),
    Kind("backend.available", "Nodes can be reached again.", ("reason",), is_input=True),
    Kind("backend.unavailable", "No node can be reached at all.", ("reason",), is_input=True),
    Kind(
        "change.cancel_requested",
        "Cancellation of a change was requested.",
        ("change",),
        is_input=True,
    ),
    Kind("change.canceled", "A change was canceled.", _ENDED),
    Kind("change.failed", "A step failed, or the part did not reach its target.", _ENDED),
    Kind(
        "change.requested",
        "A change was requested.",
        ("part", "mode?", "transition?", "parameters?"),
        is_input=True,
    ),
    Kind("change.step_ended", "A step ended.", ("change", "node", "action", "status", "error")),
    Kind("change.step_started", "A step was requested of a node.", ("change", "node", "action")),
    Kind("change.succeeded", "Every node reached its target.", _ENDED),
    Kind("change.superseded", "A newer change took over a node.", _ENDED),
    Kind("change.timed_out", "A step timed out, and the node did not answer.", _ENDED),
    Kind("emergency_stop.engaged", "The emergency stop was engaged.", ("reason",), is_input=True),
    Kind("emergency_stop.released", "The emergency stop was released.", ("reason",), is_input=True),
    Kind(
        "emergency_stop.standstill",
        "The vehicle came to a standstill after the emergency stop.",
    ),
    Kind("error.acknowledged", "An error was acknowledged.", ("error",), is_input=True),
    Kind("error.cleared", "An error was cleared.", ("error",)),
    Kind("error.raised", "An error was raised.", ("error", "message", "value", "threshold")),
    Kind(
        "goal.ended", "Navigation ended its goal.", ("goal", "succeeded", "reason"), is_input=True
    ),
    Kind(
        "goal.feedback",
        "Navigation reported its progress; causes no event yet.",
        ("goal",),
        is_input=True,
    ),
    Kind(
        "hold.release_requested", "The release of a hold was requested.", ("owner",), is_input=True
    ),
    Kind("hold.released", "A hold was released.", ("owner",)),
    Kind("hold.requested", "A hold was requested.", ("owner", "reason"), is_input=True),
    Kind("hold.set", "A hold was set.", ("owner", "reason")),
    Kind("node.answered", "A node answered a step.", ("node", "accepted", "reason"), is_input=True),
    Kind(
        "node.not_restored",
        "A node that reappeared was not restored, for a reason.",
        ("node", "target", "reason"),
    ),
    Kind("node.reachable", "A node became reachable, for the first time or again.", ("node",)),
    Kind(
        "node.reported",
        "A node reported its state.",
        ("node", "state?", "mode?", "parameters?", "reachable?"),
        is_input=True,
    ),
    Kind(
        "node.restoring",
        "A node reappeared, and a change restores it to its target (`on_return`).",
        ("node", "target"),
    ),
    Kind("node.unreachable", "A node became unreachable.", ("node",)),
    Kind(
        "part.actual_changed",
        "The state or mode of a part changed.",
        ("part", "actual", "was", "reason"),
    ),
    Kind("part.deviation_began", "A part began to deviate from its target.", _DEVIATION),
    Kind("part.deviation_ended", "A part no longer deviates from its target.", _DEVIATION),
    Kind("signal.pending", "A signal is bad, but not yet for long enough.", ("signal", "error")),
    Kind("signal.read", "A reading arrived.", ("source", "values"), is_input=True),
    Kind(
        "signal.settled",
        "A signal recovered before its error was raised.",
        ("signal", "error"),
    ),
    Kind(
        "signal.skewed",
        "A sender's clock differs from the local clock by more than 1 s.",
        ("signal",),
    ),
    Kind(
        "system_state.changed",
        "The system state or its errors changed.",
        ("state", "was", "errors", "error_code"),
    ),
    Kind("task.aborted", "Navigation gave up the task.", _TASK_ENDED),
    Kind("task.cancel_requested", "Cancellation of the task was requested.", is_input=True),
    Kind("task.canceled", "The task was canceled or replaced.", _TASK_ENDED),
    Kind("task.paused", "The task is held, and the vehicle is at standstill.", ("task", "reason")),
    Kind("task.pausing", "The task is held, and the vehicle is stopping.", ("task", "reason")),
    Kind(
        "task.requested",
        "A task was submitted.",
        ("waypoints", "length_m", "start_index", "controller", "speed_mps"),
        is_input=True,
    ),
    Kind("task.resumed", "The task resumed.", ("task", "goal", "target_index")),
    Kind("task.served", "The task was accepted.", ("task", "waypoints", "length_m")),
    Kind("task.started", "The task started.", ("task", "goal", "target_index")),
    Kind("task.succeeded", "The task succeeded.", _TASK_ENDED),
    Kind("time.passed", "A deadline or timer expired.", is_input=True),
    Kind(
        "vehicle.reported",
        "The vehicle reported its pose and speed.",
        ("x_m", "y_m", "speed_mps"),
        is_input=True,
    ),
)

_INTRODUCTION = """\
`GET /events?after=&limit=&kind=` reads events; `WS /ws` publishes them as they happen. `kind=task`
selects all kinds that begin with `task.`.

    {"type": "event", "epoch": "...", "id": 88, "at": "...", "kind": "change.succeeded",
     "cause": 87, "actor": "...", "data": {...}}

`cause` is the id of the event that caused this one, or `null` for an input from outside or from the
clock. `actor` is who made the request. Each start of the service has a new `epoch`, and ids restart
at 1. The newest 10,000 events are kept.

An *input* is recorded only when it has an effect; accepted requests are always recorded. So ten
readings a second that change nothing leave no trace ([why]).
A key with `?` is present only where it applies.

[why]: ../decisions/0007-an-input-is-recorded-when-something-follows-from-it.md"""


def events_page() -> str:
    """Return the page `events.md`.

    Raises:
        UndescribedError: A kind is emitted that is not in `KINDS`, or the reverse.
    """
    composed = {f"change.{status}" for status in ChangeStatus if status != "running"}
    composed |= {f"task.{phase.lower()}" for phase in _TASK_ENDS}
    require_described("events", event_kinds() | composed, {kind.name for kind in KINDS})
    rows = (
        (code(kind.name), "input" if kind.is_input else "", kind.about, _keys(kind))
        for kind in KINDS
    )
    return page("Events", _INTRODUCTION, table(("kind", "", "meaning", "data"), rows))


def _keys(kind: Kind) -> str:
    return ", ".join(map(code, kind.keys))
