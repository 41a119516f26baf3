import pytest

from api.cli.command_line import main


def test_check_hands_on_what_it_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[tuple[str, str]] = []

    def check(*asked: str) -> int:
        given.append((asked[0], asked[1]))
        return 1

    monkeypatch.setattr("api.http.model_check.check", check)

    assert main(["check", "robot.yaml"]) == 1
    main(["check", "-", "--format", "json"])

    assert given == [("robot.yaml", "text"), ("-", "json")]
