"""What the page does for who has only a keyboard."""

import re

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Page, expect

from tests.browser.places import stop
from tests.browser.station import Complaints, Service

pytestmark = pytest.mark.browser

SLOW_MS = 15_000
KEYS_AT_MOST = 12


def focused_in(page: Page, region: str) -> bool:
    script = f"document.getElementById('{region}').contains(document.activeElement)"
    return bool(page.evaluate(script))


class Typist:
    """Presses keys, and counts them."""

    def __init__(self, page: Page) -> None:
        self._page = page
        self.count = 0

    def press(self, *keys: str) -> None:
        for key in keys:
            self._page.keyboard.press(key)
            self.count += 1

    def until(self, key: str, name: str) -> None:
        """Press until what has the focus has that name."""
        script = (
            "document.activeElement.matches('a, button') ? document.activeElement.textContent : ''"
        )
        while name not in self._page.evaluate(script):
            assert self.count < KEYS_AT_MOST, self._page.evaluate(
                "document.activeElement.outerHTML"
            )
            self.press(key)


def test_stop_has_a_key_of_its_own_that_works_while_somebody_types(
    desktop: Page, complaints: Complaints
) -> None:
    expect(stop(desktop)).to_have_attribute("aria-keyshortcuts", "Shift+Escape")
    expect(stop(desktop)).to_have_attribute("title", re.compile(r"Shift\+Esc"))
    desktop.get_by_role("searchbox").first.fill("drive")
    desktop.keyboard.press("Shift+Escape")
    expect(stop(desktop)).to_contain_text("ENGAGED")
    assert complaints.messages == []


@pytest.mark.parametrize("way", ["skip link", "key"])
def test_a_mode_is_switched_with_at_most_twelve_keys_from_the_top(
    desktop: Page, service: Service, way: str
) -> None:
    service.request("POST", "/systems/actuation/mode?wait=15", {"mode": "MODERATE"})
    # Its modes are there, and as they are after the request.
    expect(desktop.get_by_role("radio", name="MODERATE")).to_contain_text("actual", timeout=SLOW_MS)
    expect(desktop.get_by_role("radio", name="PERFORMANCE")).to_be_enabled()
    typist = Typist(desktop)
    if way == "skip link":
        typist.until("Tab", "Skip to the selected part")
        expect(desktop.get_by_role("link", name="Skip to the selected part")).to_be_in_viewport()
        typist.press("Enter")
    else:
        typist.press("3")
    expect(desktop.get_by_role("radio", name="MODERATE")).to_be_focused()
    typist.until("Tab", "MODERATE")
    typist.until("ArrowRight", "PERFORMANCE")
    typist.press("Enter")
    change = desktop.locator("ph-change")
    expect(change).to_contain_text("PERFORMANCE", timeout=SLOW_MS)
    expect(change).to_contain_text("succeeded", timeout=SLOW_MS)
    assert typist.count <= KEYS_AT_MOST
    actual = desktop.get_by_role("radio", name="PERFORMANCE")
    expect(actual).to_contain_text("actual", timeout=SLOW_MS)
    assert service.request("GET", "/systems/actuation/mode")["mode"] == "PERFORMANCE"


@pytest.mark.parametrize(
    ("key", "region"),
    [("1", "parts"), ("2", "map"), ("3", "selected"), ("4", "signals"), ("5", "log"), ("6", "why")],
)
def test_a_figure_puts_the_focus_into_a_region(desktop: Page, key: str, region: str) -> None:
    expect(desktop.locator("ph-signal-row").first).to_be_visible()
    desktop.keyboard.press(key)
    assert focused_in(desktop, region)


def test_the_keys_are_listed_and_those_without_a_modifier_can_be_turned_off(desktop: Page) -> None:
    desktop.keyboard.press("?")
    keys = desktop.locator(".keys")
    expect(keys).to_be_visible()
    expect(keys).to_contain_text("Shift+Esc")
    desktop.get_by_role("switch", name="Keys without a modifier").uncheck()
    desktop.keyboard.press("Escape")
    expect(keys).to_be_hidden()
    desktop.keyboard.press("?")
    desktop.keyboard.press("4")
    expect(keys).to_be_hidden()
    assert not focused_in(desktop, "signals")
    desktop.keyboard.press("Shift+Escape")
    expect(stop(desktop)).to_contain_text("ENGAGED")


def test_a_key_types_where_somebody_types(desktop: Page) -> None:
    field = desktop.get_by_role("searchbox").first
    field.press_sequentially("4?")
    expect(field).to_have_value("4?")
    expect(desktop.locator(".keys")).to_be_hidden()


def test_the_tabs_of_a_phone_follow_the_arrows(phone: Page) -> None:
    tabs = phone.get_by_role("tablist", name="Panels").get_by_role("tab")
    tabs.first.focus()
    for name in ("Map", "Parts", "Signals"):
        phone.keyboard.press("ArrowRight")
        expect(phone.get_by_role("tab", name=name)).to_be_focused()
        expect(phone.get_by_role("tab", name=name)).to_have_attribute("aria-selected", "true")
    expect(phone.locator("#signals")).to_be_visible()
    expect(phone.locator("#map")).to_be_hidden()
    phone.keyboard.press("Home")
    expect(phone.get_by_role("tab", name="Status")).to_be_focused()
