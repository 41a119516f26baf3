"""The table of the page about inference is what the inference says."""

from pathlib import Path

import pytest

from domain.inputs import NodeReport
from domain.parts.mode_inference import ModeInference
from domain.state_and_mode import PartName, StateAndMode
from service.files.model_file import load_model
from tests.support.shared import PROJECT

PAGE = PROJECT / "docs" / "explanation" / "inference.md"
MODEL = PROJECT / "service" / "example" / "actuation.yaml"
ACTUATION = PartName("actuation")


def rows(page: Path) -> list[list[str]]:
    """Return target, both nodes and the system of each worked example."""
    lines = page.read_text(encoding="utf-8").splitlines()
    head = next(n for n, line in enumerate(lines) if "`manipulator` | `actuation`" in line)
    found = []
    for line in lines[head + 2 :]:
        if not line.startswith("|"):
            break
        found.append([cell.strip().replace("\\", "") for cell in line.split("|")[1:5]])
    return found


@pytest.mark.parametrize(
    ("target", "drive_base", "manipulator", "actuation"), rows(PAGE), ids=lambda cell: str(cell)
)
def test_a_worked_example_is_what_is_inferred(
    target: str, drive_base: str, manipulator: str, actuation: str
) -> None:
    inference = ModeInference(load_model(MODEL).model)
    for name, label in (("drive_base", drive_base), ("manipulator", manipulator)):
        if label != "unknown":
            said = StateAndMode.parse(label)
            inference.report(NodeReport(PartName(name), state=said.state, mode=said.mode))
    if target != "none":
        inference.set_targets({ACTUATION: StateAndMode.parse(target)})

    assert inference.actual(ACTUATION).state_and_mode.label == actuation


def test_there_are_worked_examples() -> None:
    assert len(rows(PAGE)) >= 13
