from pathlib import Path

import pytest

from api.cli.command_line import main
from service.files.model_file import EXAMPLE


def test_simulate_hands_on_what_it_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[tuple[object, ...]] = []

    def simulate(*asked: object) -> int:
        given.append(asked)
        return 1

    monkeypatch.setattr("api.cli.scenario_run.simulate", simulate)

    assert main(["simulate", "s.yaml"]) == 1
    assert main(["simulate", "-", "--format", "json", "--robot", "r", "--model", "m"]) == 1

    assert given == [
        ("s.yaml", "text", EXAMPLE, None, None),
        ("-", "json", EXAMPLE, Path("m"), Path("r")),
    ]
