"""`POST /inference` against what the C++ of micro-ROS system_modes answers.

The route is stateless and the vectors are not: what they report adds up here, and all of it is sent
with each question.
"""

import json
from collections.abc import Mapping
from http import HTTPStatus
from pathlib import Path
from typing import Any

import pytest

from tests.support.blocking_service import BlockingService
from tests.support.inference_vectors import OVERRULED, OVERRULED_FACTS, Case, Parts, run_case
from tests.support.shared import json_cases, shared_folder

FOLDER = "conformance/system_modes"
SUITES = "seed_annex4", "unit_inference", "unit_rules", "inference_semantics", "random"


class Remote:
    """`POST /inference`, in the words of the vectors; asked only when an answer is wanted."""

    def __init__(self, service: BlockingService, model: str) -> None:
        self._service = service
        self._body: dict[str, Any] = {"model": model, "targets": {}, "nodes": {}}
        self._answer: dict[str, Any] | None = None
        self.is_valid = self._take(self._body)
        self._known: dict[str, set[str]] = {"targets": set(), "nodes": set()}
        answered: dict[str, Any] = self._answer["parts"] if self._answer else {}
        for part, shown in answered.items():
            self._known["targets"].add(part)
            if not shown["inferred"]:
                self._known["nodes"].add(part)

    def set_target(self, part: str, state: str, mode: str) -> None:
        target = {"state": state, "mode": mode or None}
        self._tell("targets", part, target)

    def report(
        self,
        node: str,
        state: str | None = None,
        mode: str | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> bool:
        facts = dict(self._body["nodes"].get(node, {"state": None, "mode": None}))
        if state is not None:
            facts["state"] = state
            facts["mode"] = facts["mode"] if state == "active" else None
        if mode is not None:
            facts["mode"] = mode
        facts["parameters"] = {**facts.get("parameters", {}), **(parameters or {})}
        return self._tell("nodes", node, facts)

    def actual(self) -> Parts:
        return {
            part: {
                "kind": "system" if shown["inferred"] else "node",
                "state": shown["state"],
                "mode": shown["mode"] or "",
                "undecidable": shown["undecidable"],
            }
            for part, shown in self._asked()["parts"].items()
        }

    def targets(self) -> dict[str, dict[str, str] | None]:
        return {part: _pair(target) for part, target in self._body["targets"].items()}

    def deviations(self) -> dict[str, dict[str, dict[str, str]]]:
        return {
            item["part"]: {"target": _pair(item["target"]), "actual": _pair(item["actual"])}
            for item in self._asked()["deviations"]
        }

    def _tell(self, member: str, part: str, what: dict[str, Any]) -> bool:
        """Keep what is said of a part; whether it is taken, an unknown part is asked about now."""
        body = {**self._body, member: {**self._body[member], part: what}}
        if part not in self._known[member]:
            return self._take(body)
        self._body, self._answer = body, None
        return True

    def _take(self, body: dict[str, Any]) -> bool:
        """Keep what was said, unless it is refused."""
        answer = self._service.post("/inference", body)
        if answer.status_code == HTTPStatus.UNPROCESSABLE_ENTITY:
            return False
        assert answer.status_code == HTTPStatus.OK, answer.text
        self._body, self._answer = body, answer.json()
        return True

    def _asked(self) -> dict[str, Any]:
        """Return the answer to all that was said."""
        if self._answer is None:
            assert self._take(self._body)
        assert self._answer is not None
        return self._answer


def _pair(pair: Mapping[str, str | None]) -> dict[str, str]:
    return {"state": pair["state"] or "", "mode": pair["mode"] or ""}


def cases(suite: str) -> list[object]:
    return json_cases(f"{FOLDER}/cases", f"{suite}.json", "cases")


def text_of(case: Case) -> str:
    text: str | None = case["model"].get("yaml")
    if text is not None:
        return text
    path = Path(shared_folder(FOLDER), case["model"]["path"])
    if not path.is_file():
        pytest.skip("a file that is not there cannot be posted")
    return path.read_text(encoding="utf-8")


@pytest.mark.parametrize("case", [case for suite in SUITES for case in cases(suite)])
def test_the_interface_infers_what_the_vectors_say(case: Case, service: BlockingService) -> None:
    remote = Remote(service, text_of(case))
    if case["name"] in OVERRULED:
        reason = OVERRULED[case["name"]]
        assert not remote.is_valid or _differs(case, remote), f"not overruled any more: {reason}"
        return
    if any("load" in step.get("expect", {}) for step in case["steps"]):
        assert not remote.is_valid
        return
    overruled = {what for name, what in OVERRULED_FACTS if name == case["name"]}
    for number, what, expected, found in run_case(case, remote):
        if what not in overruled:
            steps = json.dumps(case["steps"][: number + 1])
            assert found == expected, f"step {number}: {what}\n{steps}"


def _differs(case: Case, remote: Remote) -> bool:
    return any(expected != found for _, _, expected, found in run_case(case, remote))
