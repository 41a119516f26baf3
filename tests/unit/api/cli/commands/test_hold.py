"""Holds at the command line."""

import json

import pytest

from api.cli.command_line import main
from tests.support.asked_service import AskedService

Output = pytest.CaptureFixture[str]

LUNCH = {"owner": "operator", "reason": "lunch break", "since_at": "2026-05-04T12:00:00.000Z"}
LINE = "held by operator: lunch break  [since 2026-05-04T12:00:00.000Z]"


@pytest.fixture
def service(monkeypatch: pytest.MonkeyPatch) -> AskedService:
    service = AskedService(
        {
            "PUT /holds/operator": LUNCH,
            "PUT /holds/loading%2F1": {**LUNCH, "owner": "loading/1"},
            "GET /holds": {"items": [LUNCH]},
        }
    )
    service.stand_in(monkeypatch)
    return service


def test_all_words_are_the_reason_and_how_to_release_it_is_told(
    service: AskedService, capsys: Output
) -> None:
    assert main(["hold", "lunch", "break"]) == 0

    assert service.writes == [("PUT", "/holds/operator", {"reason": "lunch break"})]
    assert capsys.readouterr().out.splitlines() == [
        LINE,
        "to release it: pilothouse release operator",
    ]


def test_a_reason_is_not_needed_and_may_be_anywhere(service: AskedService) -> None:
    assert main(["hold"]) == 0
    assert main(["hold", "the", "--owner", "loading/1", "cart"]) == 0

    assert service.writes == [
        ("PUT", "/holds/operator", {"reason": ""}),
        ("PUT", "/holds/loading%2F1", {"reason": "the cart"}),
    ]


def test_what_the_service_ignores_is_told(service: AskedService, capsys: Output) -> None:
    service.answers["PUT /holds/operator"] = {**LUNCH, "ignored": [{"message": "too long"}]}

    assert main(["hold", "lunch"]) == 0
    assert "ignored: too long" in capsys.readouterr().err


def test_holds_are_listed(service: AskedService, capsys: Output) -> None:
    assert main(["hold", "--list"]) == 0
    service.answers["GET /holds"] = {"items": []}
    assert main(["hold", "--list"]) == 0

    assert capsys.readouterr().out.splitlines() == [LINE, "no holds"]
    assert not service.writes


def test_programs_get_json(service: AskedService, capsys: Output) -> None:
    main(["hold", "lunch", "--format", "json"])
    main(["hold", "--list", "--format", "json"])

    first, second = capsys.readouterr().out.splitlines()
    assert json.loads(first) == LUNCH
    assert json.loads(second) == {"items": [LUNCH]}
    assert service.writes
