"""Events: every kind with what it means and what it carries."""

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
    """Of its data; one with `?` is there only where it applies."""
    is_input: bool = False
    """It came from outside, or from the clock, and is recorded when something follows from it."""


_ENDED = ("change", "part", "reason")
_TASK_ENDED = ("task", "reason", "progress")
_TASK_ENDS = (TaskPhase.SUCCEEDED, TaskPhase.CANCELED, TaskPhase.ABORTED)
_DEVIATION = ("part", "target", "actual", "reason")

KINDS = (
    Kind(
        "audit.write",
        "A request that was to change something was answered.",
        ("method", "path", "status", "address"),
        is_input=True,
    ),
    Kind("backend.available", "Nodes can be reached again.", ("reason",), is_input=True),
    Kind("backend.unavailable", "No node can be reached at all.", ("reason",), is_input=True),
    Kind("change.cancel_requested", "Somebody cancels a change.", ("change",), is_input=True),
    Kind("change.canceled", "A change was canceled.", _ENDED),
    Kind("change.failed", "A step failed, or the part is not where it should be.", _ENDED),
    Kind(
        "change.requested",
        "Somebody asks for a change.",
        ("part", "mode?", "transition?", "parameters?"),
        is_input=True,
    ),
    Kind("change.step_ended", "A step ended.", ("change", "node", "action", "status", "error")),
    Kind("change.step_started", "A node is asked for a step.", ("change", "node", "action")),
    Kind("change.succeeded", "Every node is where it should be.", _ENDED),
    Kind("change.superseded", "A newer change took a node over.", _ENDED),
    Kind("change.timed_out", "A step was late, and the node did not answer.", _ENDED),
    Kind("emergency_stop.engaged", "Somebody stops the robot.", ("reason",), is_input=True),
    Kind("emergency_stop.released", "Somebody releases the stop.", ("reason",), is_input=True),
    Kind("emergency_stop.standstill", "The vehicle was seen to stand since the stop."),
    Kind("error.acknowledged", "Somebody has seen an error.", ("error",), is_input=True),
    Kind("error.cleared", "An error is over.", ("error",)),
    Kind("error.raised", "An error is on.", ("error", "message", "value", "threshold")),
    Kind(
        "goal.ended", "Navigation ended its goal.", ("goal", "succeeded", "reason"), is_input=True
    ),
    Kind(
        "goal.feedback",
        "Navigation says how far it is; nothing follows from it yet.",
        ("goal",),
        is_input=True,
    ),
    Kind("hold.release_requested", "Somebody lets go.", ("owner",), is_input=True),
    Kind("hold.released", "A hold is over.", ("owner",)),
    Kind("hold.requested", "Somebody holds the task.", ("owner", "reason"), is_input=True),
    Kind("hold.set", "A hold began.", ("owner", "reason")),
    Kind("node.answered", "A node answers a step.", ("node", "accepted", "reason"), is_input=True),
    Kind(
        "node.not_restored",
        "A node that returned is left as it is, for a reason.",
        ("node", "target", "reason"),
    ),
    Kind("node.reachable", "A node is heard of, for the first time or again.", ("node",)),
    Kind(
        "node.reported",
        "A node says what it is in.",
        ("node", "state?", "mode?", "parameters?", "reachable?"),
        is_input=True,
    ),
    Kind(
        "node.restoring",
        "A node returned, and a change brings it to its target (`on_return`).",
        ("node", "target"),
    ),
    Kind("node.unreachable", "Nothing is heard of a node any more.", ("node",)),
    Kind(
        "part.actual_changed",
        "A part is in another state or mode.",
        ("part", "actual", "was", "reason"),
    ),
    Kind("part.deviation_began", "A part is not as it should be.", _DEVIATION),
    Kind("part.deviation_ended", "A part is as it should be.", _DEVIATION),
    Kind("signal.pending", "A signal is bad, and its time counts.", ("signal", "error")),
    Kind("signal.read", "A reading arrived.", ("source", "values"), is_input=True),
    Kind("signal.settled", "A signal is good again before its time.", ("signal", "error")),
    Kind("signal.skewed", "A sender's clock differs from ours by more than 1 s.", ("signal",)),
    Kind(
        "system_state.changed",
        "State or errors of the robot are others.",
        ("state", "was", "errors", "error_code"),
    ),
    Kind("task.aborted", "Navigation gave the task up.", _TASK_ENDED),
    Kind("task.cancel_requested", "Somebody cancels the task.", is_input=True),
    Kind("task.canceled", "The task was canceled or replaced.", _TASK_ENDED),
    Kind("task.paused", "The task is held, and the vehicle stands.", ("task", "reason")),
    Kind("task.pausing", "The task is held, and the vehicle comes to rest.", ("task", "reason")),
    Kind(
        "task.requested",
        "Somebody serves a task.",
        ("waypoints", "length_m", "start_index", "controller", "speed_mps"),
        is_input=True,
    ),
    Kind("task.resumed", "The task goes on.", ("task", "goal", "target_index")),
    Kind("task.served", "The task is taken.", ("task", "waypoints", "length_m")),
    Kind("task.started", "The task begins.", ("task", "goal", "target_index")),
    Kind("task.succeeded", "The task is done.", _TASK_ENDED),
    Kind("time.passed", "Something was due.", is_input=True),
    Kind(
        "vehicle.reported",
        "The vehicle says where it is.",
        ("x_m", "y_m", "speed_mps"),
        is_input=True,
    ),
)

_INTRODUCTION = """\
`GET /events?after=&limit=&kind=` reads them, `WS /ws` sends them as they happen. `kind=task` stands
for all kinds that begin with `task.`.

    {"type": "event", "epoch": "...", "id": 88, "at": "...", "kind": "change.succeeded",
     "cause": 87, "actor": "...", "data": {...}}

`cause` is the id of the event that led to this one; `null`: it came from outside, or from the
clock. `actor` says who asked. `epoch` is another one after each start of the service, and ids begin
at 1 again. The newest 10,000 are kept.

An *input* is recorded when something follows from it; requests that are accepted always are. So ten
readings a second that change nothing leave no trace ([why]).
A key with `?` is there only where it applies.

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
    return page("Events", _INTRODUCTION, table(("kind", "", "what happened", "data"), rows))


def _keys(kind: Kind) -> str:
    return ", ".join(map(code, kind.keys))
