"""What the cards of the signals say, in the only engine that runs them."""

from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Page

from api.cli.monitor import words
from tests.support.monitor import AT, signal

pytestmark = pytest.mark.browser

PENDING = {"error": "GPS_LOST", "since_at": AT, "needs_s": 15.0}
STALE = signal("temperature", 30.0, error="STALE_DATA", stale=True)
NEVER = signal("temperature", None, received_at=None)


def run(page: Page, script: str, argument: object) -> Any:  # noqa: ANN401 - what it returns
    return page.evaluate(
        f"""async (given) => {{
            const words = await import("/web/js/base/signal_words.js");
            {script}
        }}""",
        argument,
    )


@pytest.mark.parametrize(
    ("given", "live", "lost", "terminal"),
    [
        (signal("temperature", 30.0), "OK", "no contact", "ok"),
        (NEVER, "no data", "no contact", "no data"),
        ({**NEVER, "stale": True}, "stale", "was stale", "stale"),
        (STALE, "STALE_DATA", "was STALE_DATA", "STALE_DATA"),
        (
            signal("gps_accuracy", 250, pending=PENDING),
            "GPS_LOST in 12 s",
            "no contact",
            "GPS_LOST in 12 s",
        ),
    ],
)
def test_nothing_is_ok_that_was_never_received_and_nothing_at_all_without_contact(
    page: Page, given: words.Json, live: str, lost: str, terminal: str
) -> None:
    script = """
        const now = Date.parse("2026-05-04T12:00:03.000Z");
        return [true, false].map((isLive) => words.verdict(given, isLive, now).text);
    """
    assert run(page, script, given) == [live, lost]
    pending_s = 3.0 if given["pending"] else None
    assert words.verdict_words(given, pending_s) == terminal
    assert words.verdict_words(given, pending_s, is_live=False) == lost


def test_under_the_emergency_stop_no_card_says_released(page: Page) -> None:
    script = """
        return [true, false].map((engaged) => words.valueWords("estop", given, { engaged }));
    """
    stop = signal("estop", value=False)
    assert run(page, script, stop) == [
        ["stop engaged", "", "signal: not pressed"],
        ["not pressed", "", ""],
    ]
    assert words.value_words(stop, is_stop_engaged=True) == "stop engaged (signal: not pressed)"
    assert words.value_words(stop) == "not pressed"


@pytest.mark.parametrize(
    ("value", "unit", "shown"),
    [
        (1800.123456789, "kg", "1800.1 kg"),
        (0.0123456789, "m", "0.012 m"),
        (0.0123456789, "T", "0.012346 T"),
        (12.3456789, "A", "12.35 A"),
        (61.0, "°C", "61.0 °C"),
        (12345.678, "m", "12346 m"),
        (123456.789, "", "123457"),
        (0.4257, "ratio", "42.6 %"),
        (0.9, "ratio", "90 %"),
        (12, "", "12"),
        (0, "m", "0.00 m"),
        (-3.5, "m", "-3.50 m"),
    ],
)
def test_page_and_terminal_show_a_number_with_digits_that_one_can_use(
    page: Page, value: float, unit: str, shown: str
) -> None:
    load = signal("load", value, unit)
    [text, said_unit, _] = run(page, 'return words.valueWords("load", given, null);', load)
    assert f"{text} {said_unit}".rstrip() == shown
    assert words.value_words(load) == shown
