"""Runs the inference vectors of `conformance/system_modes` against anything that can infer.

The vectors hold what the unmodified C++ of micro-ROS system_modes answers. What this project does
differently on purpose is listed in `OVERRULED`, each with its reason, and in docs/conformance.md.
"""

from collections.abc import Iterator, Mapping
from typing import Any, Protocol

OVERRULED: Mapping[str, str] = {
    "unknown_part_blocks_system": "a mode that names an unknown part is an error of the model",
    "unknown_part_but_active_part_first": "a mode that names an unknown part is an error",
    "target_unconfigured_is_undecidable": (
        "a system whose parts all are unconfigured, as was asked of it, is unconfigured"
    ),
}
"""Whole cases by name, with the reason."""

_ON_THE_WAY = "towards unconfigured and finalized a system is cleaningup and shuttingdown"
_NO_STATE_FROM_PARAMETERS = "a node that never reported a state is unknown, whatever its parameters"

OVERRULED_FACTS: Mapping[tuple[str, str], str] = {
    ("random_0", "actual of s1"): _NO_STATE_FROM_PARAMETERS,
    ("random_0", "actual of s3"): _NO_STATE_FROM_PARAMETERS,
    ("random_30", "actual of s5"): _ON_THE_WAY,
    ("random_56", "actual of s1"): _ON_THE_WAY,
    ("random_223", "actual of s1"): _ON_THE_WAY,
    ("random_223", "actual of s3"): f"its part s1: {_ON_THE_WAY}",
}
"""Single facts by case and what is asserted, with the reason."""

Case = dict[str, Any]
Parts = dict[str, dict[str, Any]]


class Inferring(Protocol):
    """What the vectors need of an implementation."""

    def set_target(self, part: str, state: str, mode: str) -> None:
        """Record a target; an unknown part is ignored."""

    def report(
        self,
        node: str,
        state: str | None = None,
        mode: str | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> bool:
        """Take in a report; return False if it is refused."""

    def actual(self) -> Parts:
        """Return state, mode ("" for none) and undecidable of every part."""

    def targets(self) -> dict[str, dict[str, str] | None]:
        """Return the targets of every part."""

    def deviations(self) -> dict[str, dict[str, dict[str, str]]]:
        """Return target and actual of each part that deviates."""


def run_case(case: Case, inferring: Inferring) -> Iterator[tuple[int, str, Any, Any]]:
    """Yield (step, what, expected, found) for every fact that the case asserts."""
    for number, step in enumerate(case["steps"]):
        if "do" in step:
            taken = _do(step, inferring)
            if taken is not None:
                yield number, f"{step['do']} is taken", "error" not in step, taken
        elif "expect" in step:
            yield from ((number, *fact) for fact in _facts(case, step["expect"], inferring))


def _do(step: dict[str, Any], inferring: Inferring) -> bool | None:
    action = step["do"]
    if action == "set_target":
        inferring.set_target(step["part"], step["state"], step["mode"])
        return None
    if action == "report_state":
        return inferring.report(step["node"], state=step["state"])
    if action == "report_mode":
        return inferring.report(step["node"], mode=step["mode"])
    if action == "report":
        return inferring.report(step["node"], state=step["state"], mode=step["mode"] or None)
    if action == "report_parameters":
        inferring.report(step["node"], parameters=step["parameters"])
        return None
    raise AssertionError(f"unknown action {action}")


def _facts(
    case: Case, expect: dict[str, Any], inferring: Inferring
) -> Iterator[tuple[str, Any, Any]]:
    found = inferring.actual()
    seen = expect.get("get_or_infer", {})
    actual = expect.get("recommended_actual") or expect.get("actual", {})
    for part, want in actual.items():
        if part not in found:
            continue
        mode = want["mode"]
        # The C++ monitor shows a node by its parameters alone; a reported mode outranks them.
        if found[part]["kind"] == "node" and want["state"] == "active" and part in seen:
            mode = seen[part].get("mode", mode)
        wanted = {**want, "mode": mode, "undecidable": want.get("undecidable", False)}
        yield f"actual of {part}", wanted, {k: found[part][k] for k in wanted}
    for part, target in expect.get("targets", {}).items():
        yield f"target of {part}", target, inferring.targets().get(part)
    if "deviations" in expect:
        yield "deviations", expect["deviations"], inferring.deviations()
