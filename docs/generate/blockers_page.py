"""Blockers and reasons: why a change is not possible now, or why the robot is in ERROR."""

from collections.abc import Iterator

from api.http.routes.service_health import GRAPH_CODES
from docs.generate.markdown import code, page, table
from docs.generate.source_scan import codes_given_to, codes_in, require_described
from domain.changes.admission import ADVISORY
from domain.changes.guards import INVARIANT
from domain.conditions.explanation import CONDITION, UNKNOWN_VALUE
from domain.errors import (
    BackendUnavailableError,
    OfflineError,
    OwnedBySupervisorError,
    StorageDegradedError,
)
from domain.health.built_in_errors import ALL_OF_NODES, OF_DEVICES
from domain.health.part_errors import DEVIATES_AFTER
from domain.health.signals import (
    DECLARED_BIT,
    ESTOP,
    RATIO,
    STALE_DATA,
    STALE_DATA_BIT,
    Bound,
    SignalKind,
    SignalSettings,
    default_signals,
)
from domain.reactions.obstacles import AT_REST, NO_LIFECYCLE, NOT_REQUESTED
from domain.reactions.reaction import ACKNOWLEDGE, REACTION
from domain.reactions.returns import RESTART, TOO_OFTEN
from domain.reactions.rule_watch import RULE
from domain.tasks.standstill import STANDSTILL_UNKNOWN, STILL_MOVING
from domain.timebase import to_seconds

_OF_CHANGES = {
    ESTOP: "A node would be activated while ESTOP is active.",
    BackendUnavailableError.code: "The whole backend is down; the request is answered with 503.",
    OwnedBySupervisorError.code: "Asked at a device: its supervisor is connected, and commands the "
    "part.",
    OfflineError.code: "Asked at a device: it does not hear its supervisor, who commands the part.",
    "FINALIZED": "A node is finalized: its process must be restarted.",
    "ERROR_PROCESSING": "A node is processing an error; it will soon report its final state.",
    "UNREACHABLE": "A node is unreachable.",
    "UNKNOWN_STATE": "A node has never reported its state.",
    "DEVICE_LOST": "The device that owns a node is not connected; it is among the `causes` of that "
    "node's blocker. What is shown of the node is what was known last.",
}
_OF_THE_VEHICLE = {
    STILL_MOVING: "The vehicle moves after the time for a stop: 1 s, and 1.25 times the time that "
    "braking with [`driving.braking_mps2`](settings.md) takes.",
    STANDSTILL_UNKNOWN: "No pose shows after that time whether the vehicle stands.",
}
_OF_CONDITIONS = {
    CONDITION: "A condition is false.",
    UNKNOWN_VALUE: "A condition is neither true nor false, since something that it names is not "
    "known: a signal that was never seen or is stale, a silent node, an old pose.",
    "DEVIATES": "A part is not where its target says; the message names the part below it.",
    "HOLD": "A hold keeps the task paused.",
}
_OF_TARGETS = {
    RULE: "A part is as a rule of the model says.",
    REACTION: "A [reaction](../how-to/let-the-robot-react.md) acts, or a stronger one does; it "
    "refuses requests that lead elsewhere.",
    AT_REST: "The part was deactivated, cleaned up or shut down on request; a reaction does not "
    "activate it.",
    NOT_REQUESTED: "Nothing was ever requested of the part; a reaction does not activate it.",
    NO_LIFECYCLE: "The node has no lifecycle, so that a reaction cannot restart it.",
    ACKNOWLEDGE: "The cause of a reaction is gone, and nobody has acknowledged it.",
    INVARIANT: "An invariant of the mode is broken, or the time for which its guards have to hold "
    "is not over.",
    ESTOP: "ESTOP was active when the part would have returned.",
    RESTART: "The service was restarted, and nothing has been requested since.",
    TOO_OFTEN: "The part has returned too often within a minute.",
}
_OF_PARTS = {
    "PROCESS_ENDED": "The [process](../how-to/start-a-robots-processes.md) of the node ended, and "
    "nobody had asked for that; until the next one has run for a second.",
    "PROCESS_GIVEN_UP": "The process of the node ended too often: it is not started again before "
    "somebody asks, also over a restart.",
    "UNREACHABLE": "The node cannot be reached, or was never heard of.",
    "ERROR_PROCESSING": "The node is in `errorprocessing`.",
    "PARAMETERS_DRIFTED": "The node is active, no change drives it, and a parameter that it "
    "reported differs from what the mode of its effective target requires.",
    "DEVIATES": f"The part or one below it has not been where its effective target says for "
    f"{to_seconds(DEVIATES_AFTER):g} s, and no change drives it or the part that is why.",
    "CHANGE_FAILED": "The last change that was requested of the part failed or timed out; until a "
    "change that drives the part succeeds, also over a restart.",
    "INVARIANT_BROKEN": "An invariant of the mode that is in force has been broken for longer than "
    "its `grace_s`, and the mode has no `fallback` that could replace it.",
    "CHECKPOINT_TOO_FEW": "A [checkpoint](../how-to/supervise-checkpoints.md) of the node is "
    "reached less often than `min_hz` of the robot file requires.",
    "CHECKPOINT_TOO_MANY": "A checkpoint is reached more often than `max_hz` allows.",
    "CHECKPOINT_LATE": "A checkpoint did not follow another one within `within_s`.",
    "CHECKPOINT_WRONG_ORDER": "A checkpoint is not one of those that `order` lets come next.",
}
_OF_DEVICES = {
    "LATE": "The device has not been heard for `late_s` of the robot file; it is still commanded.",
    "LOST": "The device is not connected: it, or what is said to it, has not been heard for "
    "`lost_s`, or it is not dealt with. All that follows from that is explained by it.",
    "DEVICE_CONFLICT": "A process that answers by the name of the device is refused, or refuses "
    "this computer: it is a second one, or has another model.",
}
_WARNINGS = {
    "CLOCK_SKEW": "The stamps of a signal differ from the local clock by more than a second.",
    "LATE_TICKS": "Ticks were skipped: the machine is overloaded.",
    "NO_AUTHENTICATION": "Anyone who can reach the service may use it.",
    "NO_CONTROLLER": "The external controller is absent, silent, or keeps a goal: tasks are held.",
    "NO_DRIVE": "Drive commands do not reach the vehicle, so tasks are held.",
    "NO_POSE": "No current pose of the vehicle, so tasks are held.",
    "ROS_DUPLICATE_NODE": "Two nodes in the ROS graph have one name.",
    "ROS_QOS": "The ends of a topic in the ROS graph offer and ask for what does not go together.",
    "ROS_TYPE": "The ends of a topic in the ROS graph have different types.",
    "SOURCE_FAILS": "The source of a signal gives no reading, or one that the signal cannot have.",
    StorageDegradedError.code: "What happens cannot be written down: a restart may forget it.",
}

_INTRODUCTION = """\
A blocker says why a mode cannot be entered (`GET .../modes`) or why a change was rejected (409). A
reason says why the robot is in ERROR, or that the vehicle should stand and does not
(`GET /system_state`). Both have the same form:

| member | meaning |
|---|---|
| `code` | stable; see the tables below |
| `message` | the same in words, with numbers and units |
| `path` | from the requested part down to the node that causes it; for an error, the signal |
| `value`, `threshold` | the current value, and what it is compared with; `null` if there is none |
| `since_at` | since when |
| `root_cause` | whether it is a cause itself rather than the effect of another one |
| `refuses` | whether a request is rejected because of it; false: it is only shown |
| `causes` | what it follows from, in the same form; empty: it is a cause |
| `condition` | the [condition](../explanation/conditions.md) that is not true; `null`: none |"""

_VEHICLE = """\
The vehicle should stand after a task was held or ended and after a hold was set, and as long as a
task is held or the robot is in ERROR. A reason that says that it does not is the first in
`GET /system_state`, also without an error; it is `still_moving` of `GET /vehicle`, too. It ends
when the vehicle stands, or when a task drives it again."""

_PARTS = """\
Parts have these errors without a word in the model file; systems have only `DEVIATES`,
`CHANGE_FAILED` and `INVARIANT_BROKEN`.
`GET /errors` lists them beside those of signals, and so does the topic `errors` of the stream.
A model file can [declare further ones](../how-to/say-what-an-error-does.md), and give these another
severity. An error puts the robot into ERROR if its severity is `critical` or `fatal`: it sets bit
128, and is a reason whose `path` is its part. Errors of signals are `critical` unless they say
otherwise. A node that was not yet heard of since the start is UNREACHABLE, and parts may have
DEVIATES because of it; no event tells that, and it leaves nothing to acknowledge."""

_DEVICES = """\
Each [device](../how-to/spread-a-robot-over-computers.md) of a robot of several computers has these
errors, with its name in place of that of a part. A device that was not yet connected since the
start is LOST; no event tells that error."""

_HEALTH = """\
Warnings of the model and of the robot file are among them, with the codes of their
[findings](findings.md)."""

_SIGNALS = """\
`error_code` is the sum of the bits of all active errors. An error clears when its cause does, but
stays active for at least 0.2 s. All numbers are [settings](settings.md).
*for* counts from the last good reading, or from the start if there was none; with a `for_s` of all
other signals, from the first bad reading after a good one or after staleness."""


def blockers_page() -> str:
    """Return the page `blockers.md`.

    Raises:
        UndescribedError: A code of the source is not described here, or the reverse.
    """
    of_nodes = codes_in("domain/parts/node_doubts.py")
    at_devices = {OwnedBySupervisorError.code, OfflineError.code}
    of_changes = of_nodes | {ESTOP, BackendUnavailableError.code, *at_devices}
    require_described("blockers", of_changes, set(_OF_CHANGES))
    of_conditions = codes_in("domain/robot_reasons.py") | {CONDITION, UNKNOWN_VALUE}
    require_described("conditions", of_conditions, set(_OF_CONDITIONS))
    require_described("errors of parts", set(ALL_OF_NODES), set(_OF_PARTS))
    require_described("errors of devices", set(OF_DEVICES), set(_OF_DEVICES))
    warned = {*codes_given_to("WarningJson"), *GRAPH_CODES.values(), StorageDegradedError.code}
    require_described("warnings", warned, set(_WARNINGS))
    changes = (
        (code(name), "no" if name in ADVISORY else "yes", about)
        for name, about in _OF_CHANGES.items()
    )
    warnings = ((code(name), about) for name, about in sorted(_WARNINGS.items()))
    return page(
        "Blockers, reasons and errors",
        _INTRODUCTION,
        "## Changes",
        table(("code", "rejects the change", "cause"), changes),
        "A blocker that does not reject the change is a warning: an unreachable node may reappear"
        "\nbefore the deadline. Otherwise the change fails and names it.",
        "## Conditions",
        "A condition that is not true is shown as a tree: below an `and` what is not true, below an"
        "\n`or` everything, and below each comparison what it comes from.",
        table(("code", "meaning"), ((code(name), about) for name, about in _OF_CONDITIONS.items())),
        "## Effective targets",
        "Blockers of an `effective_target` say why the requested one is not in force: what caused"
        "\nthat, and why the system stays there although the cause is gone, which may also be what"
        "\nwould reject a request.",
        table(("code", "meaning"), ((code(name), about) for name, about in _OF_TARGETS.items())),
        "## Signal errors",
        _SIGNALS,
        table(("error", "bit", "signal", "when"), _errors()),
        "## Errors of parts",
        _PARTS,
        table(
            ("error", "severity", "when"),
            ((code(name), ALL_OF_NODES[name], about) for name, about in _OF_PARTS.items()),
        ),
        "## Errors of devices",
        _DEVICES,
        table(
            ("error", "severity", "when"),
            ((code(name), OF_DEVICES[name], about) for name, about in _OF_DEVICES.items()),
        ),
        "## Standstill",
        _VEHICLE,
        table(("code", "when"), ((code(name), about) for name, about in _OF_THE_VEHICLE.items())),
        "## Warnings of `/healthz`",
        _HEALTH,
        table(("code", "cause"), warnings),
    )


def _errors() -> Iterator[tuple[str, str, str, str]]:
    for settings in default_signals():
        for bound in settings.bounds:
            name = settings.spec.name
            yield code(bound.error), str(bound.bit), code(name), _when(settings, bound)
    stale = f"older than {to_seconds(default_signals()[0].stale_after):g} s, or never received"
    yield code(STALE_DATA), str(STALE_DATA_BIT), "any", stale
    yield "of a declared signal", str(DECLARED_BIT), "its own", "as declared in the robot file"


def _when(settings: SignalSettings, bound: Bound) -> str:
    spec = settings.spec
    if spec.kind is SignalKind.NUMBER:
        unit = "" if spec.unit == RATIO else f" {spec.unit}"
        words = f"{bound.comparison} {bound.threshold}{unit}"
    else:
        words = code(str(bound.threshold).lower() if spec.is_stop else f"{bound.threshold}")
    if bound.for_:
        words += f" for {to_seconds(bound.for_):g} s"
    return f"{words}, or the emergency stop is engaged" if spec.is_stop else words
