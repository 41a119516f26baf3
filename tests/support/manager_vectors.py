"""Runs the manager vectors of `conformance/system_modes` against anything that manages a robot.

What they assert is read as facts about how things end, not as the order of messages of the C++.
What this project does differently on purpose is listed in `OVERRULED`, fact by fact, and in
docs/conformance.md.
"""

from collections.abc import Iterator, Mapping
from typing import Any, Protocol

from domain.lifecycle import TRANSITIONS

Case = dict[str, Any]
Pair = dict[str, Any]
Fact = tuple[int, str, Any, Any]
"""Number of the step, what it is about, what is expected, what was found."""

_TOLD_AT_ONCE = (
    "a node tells its state as soon as it is there; the C++ waits for a transition event"
)
_CONFIGURED = "a mode asked of unconfigured nodes configures and activates them"
_NEVER_TOLD = (
    "a node that never reported a state is asked for nothing: the change waits for it, and fails "
    "at its deadline naming it"
)
_SHUTDOWN = "an unconfigured node can be shut down: `unconfigured_shutdown` of ROS 2 has the id 5"


_NO_RACE = "no rule acts while a change of its system runs: what was requested is reached and stays"


def _overruled(case: str, step: int, *facts: str, because: str) -> dict[tuple[str, int, str], str]:
    return {(case, step, fact): because for fact in facts}


_MIXED, _REDUNDANT = "launch_two_mixed_nodes", "launch_redundant_mode_changes"
_ACTUATION = ("actuation", "drive_base", "manipulator")
_PARTS = tuple(f"actual of {part}" for part in _ACTUATION)
_ARM = "actual of manipulator"
_STATES = ("state of drive_base", "state of manipulator")
_A_ASKED, _A_HAS, _B_HAS = "parameters asked of A", "parameters of A", "parameters of B"
_A_MOVED = "transitions asked of A"
_RACE, _UNDONE = "rules_race_degrades_wanted_change", "issue94_rule_undoes_user_request"
_COMPROMISED = ("camera", "guard", "manipulator", "nav2")

OVERRULED: Mapping[tuple[str, int, str], str] = {
    **_overruled("annex4_full", 0, *_PARTS, because=_TOLD_AT_ONCE),
    **_overruled("unknown_mode", 1, *_PARTS, because=_TOLD_AT_ONCE),
    **_overruled("launch_node_test", 2, _ARM, because=_TOLD_AT_ONCE),
    **_overruled("launch_node_test", 5, _ARM, because=_TOLD_AT_ONCE),
    **_overruled("launch_node_test", 8, _ARM, because=_TOLD_AT_ONCE),
    **_overruled("mode_change_on_unconfigured_nodes", 2, *_PARTS, *_STATES, because=_CONFIGURED),
    **_overruled("unknown_transition_id", 0, "shutdown is taken", because=_SHUTDOWN),
    **_overruled(_MIXED, 2, _A_MOVED, because=_NEVER_TOLD),
    **_overruled(_MIXED, 5, _A_MOVED, because=_NEVER_TOLD),
    **_overruled(_MIXED, 8, _A_MOVED, _A_ASKED, _A_HAS, because=_NEVER_TOLD),
    **_overruled(_REDUNDANT, 4, _B_HAS, because=_NEVER_TOLD),
    **_overruled(_REDUNDANT, 7, _A_ASKED, _A_HAS, _B_HAS, because=_NEVER_TOLD),
    **_overruled(_REDUNDANT, 10, _A_HAS, _B_HAS, because=_NEVER_TOLD),
    **_overruled(_REDUNDANT, 13, _A_ASKED, _A_HAS, _B_HAS, because=_NEVER_TOLD),
    **_overruled(_RACE, 5, *(f"target of {part}" for part in _ACTUATION), because=_NO_RACE),
    **_overruled(_RACE, 5, "parameters of drive_base", _STATES[1], because=_NO_RACE),
    **_overruled(_RACE, 8, "actual of actuation", _ARM, because=_NO_RACE),
    **_overruled(_UNDONE, 6, "target of safety", "state of camera", because=_NO_RACE),
    **_overruled(_UNDONE, 6, *(f"target of {part}" for part in _COMPROMISED), because=_NO_RACE),
    **_overruled(
        _UNDONE, 6, *(f"parameters of {part}" for part in _COMPROMISED[1:]), because=_NO_RACE
    ),
}
"""Single facts by case, number of the step and what is asserted, with the reason."""

TRANSITION_OF_ID: Mapping[int, str] = {rule.id: str(rule.transition) for rule in TRANSITIONS}
"""Labels by the ids of `lifecycle_msgs/msg/Transition`; shutdown has three."""


class Managing(Protocol):
    """What the vectors need of an implementation; time passes only in `wait`."""

    def request_transition(self, part: str, transition: str) -> bool:
        """Ask for a transition; return False if it is refused."""

    def request_mode(self, part: str, mode: str) -> bool:
        """Ask for a mode; return False if it is refused."""

    def wait(self, seconds: float) -> None:
        """Let time pass."""

    def trigger(self, node: str, transition: str) -> None:
        """Let somebody else ask a node for a transition."""

    def set_parameters(self, node: str, values: Mapping[str, Any]) -> None:
        """Change parameters of a node from outside."""

    def set_behaviour(self, node: str, on_transition: str) -> None:
        """Let transitions of a node end normally (""), in "failure" or in "error"."""

    def actual(self) -> dict[str, Pair]:
        """Return state, mode ("" for none) and undecidable of every part."""

    def targets(self) -> dict[str, Pair | None]:
        """Return state and mode ("" for none) that are in force for every part."""

    def node(self, name: str) -> tuple[str, Mapping[str, Any]]:
        """Return what a node really is in, and the parameters that the model knows of it."""

    def take_requests(self) -> Mapping[str, tuple[set[str], dict[str, Any]]]:
        """Return transitions and parameters asked of each node since the last call."""


def run_case(case: Case, robot: Managing) -> Iterator[Fact]:
    """Run a case; yield every fact that it asserts and that can be compared."""
    taken = True
    for number, step in enumerate(case["steps"]):
        if "expect" in step:
            yield from ((number, *fact) for fact in _facts(case, step, robot, taken=taken))
        elif "do" in step:
            answer = _do(step, robot)
            taken = taken if answer is None else answer
            if "error" in step:
                yield number, f"{step['label'] or step['id']} is taken", False, taken


def _do(step: dict[str, Any], robot: Managing) -> bool | None:
    """Do one step; return whether a request was taken, None for what is no request."""
    match step["do"]:
        case "request_transition":
            # An id that no transition has is no label either.
            label = TRANSITION_OF_ID.get(step["id"], str(step["id"]))
            return robot.request_transition(step["part"], label)
        case "request_mode":
            return robot.request_mode(step["part"], step["mode"])
        case "wait":
            robot.wait(step["seconds"])
        case "node_transition":
            robot.trigger(step["node"], step["label"])
        case "node_sets_parameters":
            robot.set_parameters(step["node"], step["parameters"])
        case "node_behaviour":
            robot.set_behaviour(step["node"], step["on_transition"])
        case unknown:
            raise AssertionError(f"unknown action {unknown}")
    return None


def _facts(
    case: Case, step: dict[str, Any], robot: Managing, *, taken: bool
) -> Iterator[tuple[str, Any, Any]]:
    expect, asserted = step["expect"], step.get("asserted", ())
    kinds = {node["name"]: node["kind"] for node in case["nodes"]}
    if "response" in expect:
        yield "response", expect["response"]["success"], taken
    # Of nodes without states of their own the C++ reads "active" from parameters; README.
    if set(kinds.values()) <= {"lifecycle"}:
        found = robot.actual()
        for part, want in (expect.get("recommended_actual") or expect["actual"]).items():
            wanted = {"undecidable": False, **want}
            yield f"actual of {part}", wanted, {key: found[part][key] for key in wanted}
    targets = robot.targets()
    for part, target in expect.get("targets", {}).items():
        yield f"target of {part}", target, targets[part]
    for name, truth in expect.get("nodes", {}).items():
        state, parameters = robot.node(name)
        if kinds[name] == "lifecycle":
            yield f"state of {name}", truth["state"], state
        known = {key: truth["parameters"][key] for key in parameters}
        yield f"parameters of {name}", known, dict(parameters)
    requests = robot.take_requests()
    if "last_requests" in asserted:
        yield from _requested(expect["last_requests"], requests)


def _requested(
    expected: Mapping[str, list[dict[str, Any]]],
    found: Mapping[str, tuple[set[str], dict[str, Any]]],
) -> Iterator[tuple[str, Any, Any]]:
    """Compare which transitions were asked for, as a set, and the last value of each parameter."""
    for node, asked in expected.items():
        transitions, parameters = found.get(node, (set(), {}))
        wanted = {request["transition"] for request in asked if "transition" in request}
        yield f"transitions asked of {node}", wanted, transitions
        values: dict[str, Any] = {}
        for request in asked:
            values |= request.get("parameters", {})
        yield f"parameters asked of {node}", values, parameters
