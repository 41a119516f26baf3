"""The inference of the core against what the C++ of micro-ROS system_modes answers."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from domain.errors import InvalidModelError, UnknownPartError
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.parts.mode_inference import ModeInference
from domain.parts.system_model import SmhModel
from domain.state_and_mode import ModeName, PartName, StateAndMode, part_name
from service.files.model_file import load_model, read_model
from service.files.text_file import UnreadableFileError
from tests.support.inference_vectors import OVERRULED, OVERRULED_FACTS, Case, Parts, run_case
from tests.support.shared import json_cases, shared_folder

SUITES = "seed_annex4", "unit_inference", "unit_rules", "inference_semantics", "random"


class Core:
    """`ModeInference`, in the words of the vectors."""

    def __init__(self, model: SmhModel) -> None:
        self.model = model
        self.inference = ModeInference(model)

    def set_target(self, part: str, state: str, mode: str) -> None:
        if part in self.model:
            target = StateAndMode(LifecycleState(state), ModeName(mode) if mode else None)
            self.inference.set_targets({PartName(part): target})

    def report(
        self,
        node: str,
        state: str | None = None,
        mode: str | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> bool:
        values = {n: tuple(v) if isinstance(v, list) else v for n, v in (parameters or {}).items()}
        report = NodeReport(
            part_name(node),
            state=LifecycleState(state) if state else None,
            mode=ModeName(mode) if mode else None,
            parameters=values or None,
        )
        try:
            self.inference.report(report)
        except UnknownPartError:
            return False
        return True

    def actual(self) -> Parts:
        return {
            part: {
                "kind": "node" if part in self.model.nodes else "system",
                "state": str(self.inference.actual(part).state),
                "mode": self.inference.actual(part).mode or "",
                "undecidable": self.inference.actual(part).undecidable,
            }
            for part in self.model.parts
        }

    def targets(self) -> dict[str, dict[str, str] | None]:
        targets = {part: self.inference.target(part) for part in self.model.parts}
        return {part: _pair(target) if target else None for part, target in targets.items()}

    def deviations(self) -> dict[str, dict[str, dict[str, str]]]:
        return {
            part: {"target": _pair(target), "actual": _pair(actual)}
            for part, target, actual in self.inference.deviations()
        }


def _pair(pair: StateAndMode) -> dict[str, str]:
    return {"state": str(pair.state), "mode": pair.mode or ""}


def cases(suite: str) -> list[Any]:
    return list(json_cases("conformance/system_modes/cases", f"{suite}.json", "cases"))


def model_of(case: Case) -> SmhModel:
    if "yaml" in case["model"]:
        return read_model(case["model"]["yaml"]).model
    folder = shared_folder("conformance/system_modes")
    return load_model(Path(folder, case["model"]["path"])).model


@pytest.mark.parametrize("case", [c for suite in SUITES for c in cases(suite)])
def test_the_core_infers_what_the_vectors_say(case: Case) -> None:
    if case["name"] in OVERRULED:
        assert _differs(case), f"it passes and is not overruled: {OVERRULED[case['name']]}"
        return
    if any("load" in step.get("expect", {}) for step in case["steps"]):
        with pytest.raises((InvalidModelError, UnreadableFileError)):
            model_of(case)
        return
    overruled = {what for name, what in OVERRULED_FACTS if name == case["name"]}
    differing = set()
    for number, what, expected, found in run_case(case, Core(model_of(case))):
        if what in overruled:
            differing |= {what} if found != expected else set()
            continue
        history = json.dumps(case["steps"][: number + 1])
        assert found == expected, f"step {number}: {what}\n{history}"
    assert differing == overruled, "what does not differ any more is not overruled"


def _differs(case: Case) -> bool:
    """Tell whether the model is refused, or a fact is another one."""
    try:
        core = Core(model_of(case))
    except InvalidModelError:
        return True
    return any(expected != found for _, _, expected, found in run_case(case, core))
