"""Shelving at the command line."""

import json

import httpx
import pytest

from api.cli.command_line import main
from tests.support.asked_service import AskedService

Output = pytest.CaptureFixture[str]

SHELVED = {"error": "ESTOP", "part": None, "shelved_until_at": "2026-05-04T12:10:00.000Z"}


@pytest.fixture
def service(monkeypatch: pytest.MonkeyPatch) -> AskedService:
    service = AskedService(
        {
            "PUT /errors/ESTOP/shelf": SHELVED,
            "DELETE /errors/ESTOP/shelf": httpx.Response(204),
        }
    )
    service.stand_in(monkeypatch)
    return service


def test_an_error_is_shelved_for_a_time_with_a_reason(
    service: AskedService, capsys: Output
) -> None:
    assert main(["shelve", "ESTOP", "--for", "1.5h", "--reason", "known"]) == 0

    assert service.writes == [("PUT", "/errors/ESTOP/shelf", {"for_s": 5_400, "reason": "known"})]
    assert capsys.readouterr().out == "ESTOP is not announced until 2026-05-04T12:10:00.000Z\n"


def test_an_error_is_taken_off_the_shelf_without_a_reason(
    service: AskedService, capsys: Output
) -> None:
    assert main(["shelve", "--end", "ESTOP"]) == 0

    assert service.writes == [("DELETE", "/errors/ESTOP/shelf", None)]
    assert capsys.readouterr().out == "ESTOP is announced again\n"


def test_programs_get_json(service: AskedService, capsys: Output) -> None:
    main(["shelve", "ESTOP", "--reason", "known", "--format", "json"])
    main(["shelve", "ESTOP", "--end", "--format", "json"])

    shelved, ended = map(json.loads, capsys.readouterr().out.splitlines())
    assert shelved == {"items": [SHELVED]}
    assert ended == {"announced": ["ESTOP"]}
    assert service.writes
