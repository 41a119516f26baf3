"""Releasing the emergency stop and holds."""

import json

import httpx
import pytest

from api.cli.command_line import main
from tests.support.asked_service import AskedService

Output = pytest.CaptureFixture[str]

ENGAGED = {"engaged": True, "reason": "dog"}
RELEASED = {"engaged": False, "reason": ""}
LUNCH = {"owner": "operator", "reason": "lunch", "since_at": "2026-05-04T12:00:00.000Z"}


@pytest.fixture
def service(monkeypatch: pytest.MonkeyPatch) -> AskedService:
    service = AskedService(
        {
            "GET /emergency_stop": [ENGAGED, RELEASED],
            "PUT /emergency_stop": RELEASED,
            "GET /holds": {"items": [LUNCH]},
            "DELETE /holds/operator": httpx.Response(204),
            "DELETE /holds/operator?volatile=true": httpx.Response(204),
        }
    )
    service.stand_in(monkeypatch)
    return service


def test_the_emergency_stop_is_released_and_what_still_holds_is_told(
    service: AskedService, capsys: Output
) -> None:
    assert main(["release", "--reason", "it ran away"]) == 0

    body = {"engaged": False, "reason": "it ran away", "volatile": False}
    assert service.writes == [("PUT", "/emergency_stop", body)]
    assert capsys.readouterr().out.splitlines() == [
        "the emergency stop is released",
        "still held by operator: lunch  [since 2026-05-04T12:00:00.000Z]",
    ]


def test_to_release_what_is_not_engaged_is_no_failure(
    service: AskedService, capsys: Output
) -> None:
    service.answers["GET /emergency_stop"] = RELEASED

    assert main(["release"]) == 0
    assert "was not engaged" in capsys.readouterr().out


def test_a_hold_is_released_by_its_owner(service: AskedService, capsys: Output) -> None:
    service.answers["GET /holds"] = [{"items": [LUNCH]}, {"items": []}]

    assert main(["release", "operator"]) == 0

    assert service.writes == [("DELETE", "/holds/operator", None)]
    assert capsys.readouterr().out.splitlines() == ["the hold of operator is released"]


def stopped(*stops: tuple[str, str | None], **more: object) -> dict[str, object]:
    """Return an emergency stop with stops of these ids on these computers."""
    told = [{"id": each, "device": device} for each, device in stops]
    nothing = {"engaged": bool(stops), "reason": "dog", "waits_for": [], "not_heard": []}
    return {**nothing, "stops": told, **more}


def test_only_what_was_there_before_is_released(service: AskedService, capsys: Output) -> None:
    later = stopped(("stop-9", None))
    service.answers["GET /emergency_stop"] = [stopped(("stop-7", None), ("arm-1", "arm")), later]
    service.answers["PUT /emergency_stop"] = later

    assert main(["release"]) == 1

    assert service.writes[0][2]["stops"] == ["stop-7", "arm-1"]
    assert capsys.readouterr().out.splitlines()[0] == "the emergency stop is engaged: dog"


def test_other_computers_get_time_to_release_their_stops(
    service: AskedService, capsys: Output, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("api.cli.commands.release.sleep", lambda _: None)
    waiting = stopped(("arm-1", "arm"), waits_for=["arm"])
    service.answers["GET /emergency_stop"] = [waiting, waiting, stopped(), stopped()]
    service.answers["PUT /emergency_stop"] = waiting

    assert main(["release"]) == 0
    assert capsys.readouterr().out.splitlines()[0] == "the emergency stop is released"


def test_whose_stop_stands_is_told(service: AskedService, capsys: Output) -> None:
    service.answers["GET /emergency_stop"] = stopped(("arm-1", "arm"), not_heard=["arm"])
    service.answers["PUT /emergency_stop"] = stopped(("arm-1", "arm"), not_heard=["arm"])

    assert main(["release"]) == 1
    told = capsys.readouterr().out.splitlines()
    assert told[0] == "the emergency stop is engaged at device arm (not heard): dog"


def test_an_engaged_stop_is_told_though_a_hold_is_released(
    service: AskedService, capsys: Output
) -> None:
    service.answers["GET /emergency_stop"] = ENGAGED

    assert main(["release", "operator"]) == 0
    assert "the emergency stop is engaged: dog" in capsys.readouterr().out


def test_a_mistyped_owner_releases_nothing_and_is_answered_with_the_nearest(
    service: AskedService, capsys: Output
) -> None:
    service.answers["GET /holds"] = {"items": [LUNCH, {**LUNCH, "owner": "loading"}]}

    assert main(["release", "operator", "operater"]) == 1

    assert not service.writes
    told = capsys.readouterr().err
    assert "there is no hold of owner 'operater'" in told
    assert "did you mean operator?" in told


def test_while_storage_fails_it_can_be_released_all_the_same(service: AskedService) -> None:
    assert main(["release", "--volatile"]) == 0
    assert main(["release", "--volatile", "operator"]) == 0

    assert service.writes[0][2]["volatile"] is True
    assert service.writes[1][1] == "/holds/operator?volatile=true"


def test_programs_get_stop_and_holds(service: AskedService, capsys: Output) -> None:
    assert main(["release", "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"emergency_stop": RELEASED, "holds": [LUNCH]}
