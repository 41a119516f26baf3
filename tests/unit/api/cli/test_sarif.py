import json
import os
from pathlib import Path
from typing import Any

import pytest

from api.cli.checked_file import CheckedFile
from api.cli.sarif import as_sarif
from domain.findings import Finding
from service.finding_codes.all_codes import FINDING_CODES

UNKNOWN = Finding("error", "UNKNOWN_MODE", "no mode FASTT", "arm", (), 2, 4)
ALIKE = Finding("warning", "MODES_ALIKE", "A is the same as B", "arm", (), 7, 9)


def run(*files: CheckedFile) -> dict[str, Any]:
    log = json.loads(as_sarif(files))
    assert log["version"] == "2.1.0"
    assert log["$schema"].endswith("sarif-schema-2.1.0.json")
    (only,) = log["runs"]
    assert isinstance(only, dict)
    return only


def test_each_finding_is_a_result_with_its_rule_and_region() -> None:
    of_file = run(CheckedFile("robot.yaml", "", (UNKNOWN, ALIKE, UNKNOWN)))

    rules = of_file["tool"]["driver"]["rules"]
    assert [rule["id"] for rule in rules] == ["UNKNOWN_MODE", "MODES_ALIKE"]
    first, second, third = of_file["results"]
    assert (first["ruleId"], first["ruleIndex"], first["level"]) == ("UNKNOWN_MODE", 0, "error")
    assert (second["ruleIndex"], second["level"], third["ruleIndex"]) == (1, "warning", 0)
    assert second["message"] == {"text": "A is the same as B"}
    assert second["locations"] == [
        {
            "physicalLocation": {
                "artifactLocation": {"uri": "robot.yaml"},
                "region": {"startLine": 7, "startColumn": 9},
            }
        }
    ]


def test_columns_count_characters() -> None:
    assert run(CheckedFile("a", "", ()))["columnKind"] == "unicodeCodePoints"


def test_a_file_without_findings_is_an_artifact_without_results() -> None:
    of_file = run(CheckedFile("a.yaml", "", ()), CheckedFile("b.yaml", "", ()))

    assert of_file["results"] == []
    assert [own["location"]["uri"] for own in of_file["artifacts"]] == ["a.yaml", "b.yaml"]


@pytest.mark.parametrize(
    ("name", "uri"),
    [
        ("models/a b.yaml", "models/a%20b.yaml"),
        ("./a.yaml", "a.yaml"),
        ("../a.yaml", "../a.yaml"),
        ("é#1.yaml", "%C3%A9%231.yaml"),
        ("-", "stdin"),
    ],
)
def test_files_are_relative_uris(name: str, uri: str) -> None:
    assert run(CheckedFile(name, "", ()))["artifacts"][0]["location"]["uri"] == uri


def test_an_absolute_path_is_told_from_the_working_directory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    name = os.fspath(tmp_path / "models" / "a.yaml")

    of_file = run(CheckedFile(name, "", ()))
    assert of_file["artifacts"][0]["location"]["uri"] == "models/a.yaml"


def test_each_code_has_a_rule_with_help() -> None:
    findings = tuple(Finding("error", code, "odd", None, (), 1, 1) for code in FINDING_CODES)

    rules = run(CheckedFile("a", "", findings))["tool"]["driver"]["rules"]
    assert len(rules) == len(FINDING_CODES)
    for rule in rules:
        assert rule["defaultConfiguration"]["level"] in ("error", "warning")
        assert rule["help"]["text"].startswith(rule["shortDescription"]["text"])
        assert "`" not in rule["help"]["text"]
        assert "](" not in rule["help"]["markdown"]
