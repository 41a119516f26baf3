"""Signals at the command line."""

import json

import httpx
import pytest

from api.cli.command_line import main
from api.cli.commands.signal import value_of
from tests.support.asked_service import AskedService

Output = pytest.CaptureFixture[str]

BATTERY = {
    "signal": "battery_level",
    "value": 0.42,
    "unit": "ratio",
    "age_s": 3.2,
    "received_at": "2026-05-04T12:00:00.000Z",
    "source_fault": None,
    "stale": False,
    "error": "BATTERY_LOW",
    "pending": None,
}
GPS = {
    "signal": "gps_accuracy",
    "value": None,
    "unit": "mm",
    "age_s": None,
    "received_at": None,
    "source_fault": None,
    "stale": False,
    "error": None,
    "pending": None,
}


@pytest.fixture
def service(monkeypatch: pytest.MonkeyPatch) -> AskedService:
    service = AskedService(
        {
            "GET /signals": {"items": [BATTERY, GPS]},
            "GET /signals/battery_level": BATTERY,
            "POST /signals/battery_level": {"state": "ERROR", "errors": ["BATTERY_LOW"]},
        }
    )
    service.stand_in(monkeypatch)
    return service


def test_all_signals_are_shown_in_columns(service: AskedService, capsys: Output) -> None:
    assert main(["signal"]) == 0

    assert capsys.readouterr().out.splitlines() == [
        "battery_level  42 %  3 s ago  BATTERY_LOW",
        "gps_accuracy   ?     never    no data",
    ]
    assert not service.writes


def test_a_robot_without_signals_says_so(service: AskedService, capsys: Output) -> None:
    service.answers["GET /signals"] = {"items": []}

    assert main(["signal"]) == 0
    assert capsys.readouterr().out == "no signals\n"


def test_a_reading_is_submitted_and_what_follows_is_told(
    service: AskedService, capsys: Output
) -> None:
    assert main(["signal", "battery_level", "42%", "--source", "bench"]) == 0

    assert service.writes == [
        ("POST", "/signals/battery_level", {"value": 0.42, "source": "bench"})
    ]
    assert capsys.readouterr().out.splitlines() == [
        "battery_level  42 %  3 s ago  BATTERY_LOW",
        "the robot is ERROR: BATTERY_LOW",
    ]


def test_an_unknown_signal_is_answered_with_the_hint_of_the_service(
    service: AskedService, capsys: Output
) -> None:
    problem = {"detail": "there is no signal 'batery'", "hint": "did you mean battery_level?"}
    service.answers["GET /signals/batery"] = httpx.Response(404, json=problem)

    assert main(["signal", "batery"]) == 1
    assert "did you mean battery_level?" in capsys.readouterr().err


def test_programs_get_json(service: AskedService, capsys: Output) -> None:
    for words in ([], ["battery_level"], ["battery_level", "0.42"]):
        assert main(["signal", *words, "--format", "json"]) == 0

    listed, shown, followed = map(json.loads, capsys.readouterr().out.splitlines())
    assert listed == {"items": [BATTERY, GPS]}
    assert shown == BATTERY
    assert followed["state"] == "ERROR"
    assert service.writes


def test_what_the_service_ignores_is_told(service: AskedService, capsys: Output) -> None:
    answer = {"state": "ERROR", "errors": [], "ignored": [{"message": "source is too long"}]}
    service.answers["POST /signals/battery_level"] = answer

    assert main(["signal", "battery_level", "1"]) == 0
    assert "ignored: source is too long" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("true", True),
        ("ON", True),
        ("no", False),
        ("3", 3),
        ("-0.5", -0.5),
        ("1e3", 1000.0),
        ("50%", 0.5),
        ("CONNECTED", "CONNECTED"),
        ("nan", "nan"),
        ("5 %", 0.05),
        ("%", "%"),
    ],
)
def test_values_are_read_as_they_are_typed(text: str, value: object) -> None:
    assert value_of(text) == value
    assert type(value_of(text)) is type(value)
