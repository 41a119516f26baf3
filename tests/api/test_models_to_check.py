"""Broken and doubtful models: what the service and the command line say about each, and where.

The models are in `tests/data/models_to_check`; its `expected.tsv` has a line for each finding.
"""

import csv
import json
from collections import defaultdict
from pathlib import Path
from typing import TypeAlias

import pytest

from api.cli.commands.check import check
from service.files.model_file import load_model
from service.finding_codes.all_codes import OF_MODELS
from tests.support.http_robot import http_robot
from tests.support.shared import PROJECT

FOLDER = PROJECT / "tests" / "data" / "models_to_check"
MODELS = sorted(FOLDER.glob("*.yaml"))
TEXTS = {path.stem: path.read_text(encoding="utf-8") for path in MODELS}

Told: TypeAlias = tuple[str, str, int, int]
"""Severity, code, line and column."""


def _expected() -> dict[str, list[Told]]:
    expected: dict[str, list[Told]] = defaultdict(list)
    with (FOLDER / "expected.tsv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file, delimiter="\t"):
            told = (row["severity"], row["code"], int(row["line"]), int(row["column"]))
            expected[row["model"]].append(told)
    return expected


EXPECTED = _expected()


def test_there_is_a_line_for_each_model() -> None:
    assert set(EXPECTED) == {path.stem for path in MODELS}
    assert len(MODELS) >= 60


def test_each_code_that_a_model_can_have_is_shown_by_one() -> None:
    told = {code for findings in EXPECTED.values() for _, code, _, _ in findings}

    assert told == {own.code for own in OF_MODELS}


async def test_the_service_says_what_is_wrong_and_where() -> None:
    async with http_robot() as robot:
        for model, text in TEXTS.items():
            answer = (await robot.http.post("/model/check", content=text)).json()

            told = [(f["severity"], f["code"], f["line"], f["column"]) for f in answer["findings"]]
            assert (model, told) == (model, EXPECTED[model])
            assert answer["valid"] is not any(severity == "error" for severity, *_ in told)


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_the_command_line_says_the_same_with_a_caret_below_the_character(
    path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = check(str(path), "text")

    *lines, _verdict = capsys.readouterr().out.splitlines()
    heads = [line for line in lines if line.startswith(f"{path}:")]
    expected = EXPECTED[path.stem]
    assert [head.partition("]: ")[0] for head in heads] == [
        f"{path}:{line}:{column}: {severity}[{name}" for severity, name, line, column in expected
    ]
    assert sum(line.rstrip().endswith("| ^") or line.endswith(" ^") for line in lines) >= len(heads)
    assert code == any(severity == "error" for severity, *_ in expected)


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_a_program_is_told_the_same(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    check(str(path), "sarif")

    (run,) = json.loads(capsys.readouterr().out)["runs"]
    regions = [result["locations"][0]["physicalLocation"]["region"] for result in run["results"]]
    assert [
        (result["level"], result["ruleId"], region["startLine"], region["startColumn"])
        for result, region in zip(run["results"], regions, strict=True)
    ] == EXPECTED[path.stem]


EXAMPLES = [
    *(PROJECT / "examples" / "models").glob("*.yaml"),
    *(PROJECT / "service" / "example").glob("*.yaml"),
]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_nothing_is_odd_about_the_example_models(path: Path) -> None:
    assert load_model(path).warnings == ()
