"""The page on each screen: nothing is cut off, nothing lies below STOP, no word breaks."""

import re
from typing import Literal

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Page, expect

from tests.browser.states import drive
from tests.browser.station import Complaints, Service
from tests.browser.test_operator import BROKEN_WORDS

pytestmark = pytest.mark.browser

SCREENS = {
    "desktop": (1440, 900),
    "tablet": (1024, 768),
    "phone": (360, 640),
    "phone on its side": (640, 360),
    "desktop at 200 %": (720, 450),
}
"""Width and height in CSS pixels; a zoom of 200 % halves both."""
TABS = ("Status", "Map", "Parts", "Signals", "Log")

BELOW_STOP = """() => {
    const stop = document.querySelector("button.stop").getBoundingClientRect();
    const controls = document.querySelectorAll(
        ":is(header, .bands, main, .tabs) :is(button, input, select, a, [role=treeitem], summary)");
    const covered = [];
    for (const control of controls) {
        if (!control.checkVisibility() || control.closest(".stop, .visually-hidden")) continue;
        control.scrollIntoView({ block: "center" });
        const box = control.getBoundingClientRect();
        if (!box.width || !box.height) continue;
        const isBeside = box.right <= stop.left || box.left >= stop.right;
        const isApart = isBeside || box.bottom <= stop.top || box.top >= stop.bottom;
        if (!isApart) covered.push(control.outerHTML.slice(0, 120));
    }
    return covered;
}"""
"""Controls that STOP covers also when they are scrolled to."""

CUT_OFF = """() => [...document.querySelectorAll("header, .bands, main, .tabs")]
    .map((node) => [node.className || node.tagName, node.getBoundingClientRect()])
    .filter(([, box]) => box.height > 0)
    .filter(([, { left, right, bottom }]) => left < 0 || right > innerWidth || bottom > innerHeight)
    .map(([name]) => name)"""


def tabs_of(page: Page) -> tuple[str, ...]:
    """Return the tabs to look at; where all regions are in sight, there is one view."""
    if page.get_by_role("tablist", name="Panels").count() == 0:
        return ("",)
    return TABS


def look(page: Page, width: int) -> None:
    for tab in tabs_of(page):
        if tab:
            page.get_by_role("tab", name=tab, exact=False).last.click()
        assert page.evaluate("document.documentElement.scrollWidth") == width, tab
        assert page.evaluate(CUT_OFF) == [], tab
        assert page.evaluate(BELOW_STOP) == [], tab
        assert page.evaluate(BROKEN_WORDS) == [], tab
        expect(page.locator("button.stop")).to_be_in_viewport(ratio=1)
        expect(page.get_by_role("heading", level=1)).to_be_in_viewport(ratio=1)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("screen", SCREENS)
def test_everything_is_in_sight_and_nothing_is_below_stop(
    browser: Browser,
    service: Service,
    complaints: Complaints,
    screen: str,
    scheme: Literal["light", "dark"],
) -> None:
    width, height = SCREENS[screen]
    page = browser.new_page(
        viewport={"width": width, "height": height}, color_scheme=scheme, reduced_motion="reduce"
    )
    complaints.watch(page)
    page.goto(service.url)
    expect(page.locator("ph-signal-row").first).to_be_attached(timeout=10_000)
    look(page, width)
    drive(service)
    service.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    service.request("PATCH", "/mock/battery_level", {"value": 0.1})
    service.request("PUT", "/emergency_stop", {"engaged": True, "reason": "smoke in hall 3"})
    expect(page.get_by_role("heading", level=1)).to_contain_text("ERROR")
    expect(page.locator("ph-stop-release")).to_be_visible()
    look(page, width)
    assert complaints.messages == []
    page.close()


def test_with_the_colours_of_the_system_the_state_is_told_by_words_and_symbols(
    browser: Browser, service: Service, complaints: Complaints
) -> None:
    page = browser.new_page(forced_colors="active", viewport={"width": 1440, "height": 900})
    complaints.watch(page)
    page.goto(service.url)
    service.request("PATCH", "/mock/battery_level", {"value": 0.1})
    expect(page.get_by_role("heading", level=1)).to_contain_text("ERROR")
    expect(page.locator("ph-state-bar svg")).to_be_visible()
    assert complaints.messages == []
    page.close()


def test_who_wants_no_motion_sees_none(browser: Browser, service: Service) -> None:
    page = browser.new_page(reduced_motion="reduce")
    page.route("**/emergency_stop", lambda _: None)
    page.goto(service.url)
    page.get_by_role("button", name=re.compile("^STOP")).click()
    expect(page.locator(".octagon")).to_have_text("SENDING")
    assert page.evaluate("document.getAnimations().length") == 0
    page.close()


def test_few_parts_leave_their_room_to_timeline_and_signals(desktop: Page) -> None:
    expect(desktop.locator("body")).to_have_attribute("data-size", "small")
    timeline = desktop.locator(".region-timeline").bounding_box()
    assert timeline is not None
    assert timeline["x"] == 0
    assert timeline["height"] > 180


def test_a_tab_says_how_much_in_it_asks_for_attention(phone: Page, service: Service) -> None:
    service.request("PATCH", "/mock/battery_level", {"value": 0.1})
    expect(phone.get_by_role("tab", name="Status, 1 to attend to")).to_be_visible()
    expect(phone.get_by_role("tab", name="Signals, 1 to attend to")).to_be_visible()
    phone.get_by_role("tab", name="Signals").click()
    expect(phone.locator("ph-signal-row").first).to_be_visible()


def test_a_phone_shows_first_what_somebody_has_to_do(phone: Page, service: Service) -> None:
    drive(service)
    service.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    service.request("PATCH", "/mock/gps_accuracy", {"value": 250})
    status = phone.locator("main")
    expect(status.get_by_role("button", name=re.compile("Pause|Resume"))).to_be_in_viewport()
    expect(status.get_by_role("button", name="Release gate (hold)")).to_be_visible()
    expect(status.locator("#pending")).to_contain_text(
        re.compile(r"GPS accuracy.*GPS_LOST in 1\d s")
    )
