"""What an operator sees and does on the map, in a real browser and over the real service."""

import re
from collections.abc import Iterator

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Page, expect

from tests.browser.driving import (
    button,
    canvas,
    choose,
    hold,
    open_sheet,
    sheet,
    start,
    strip,
    words,
)
from tests.browser.station import Complaints, Service

pytestmark = pytest.mark.browser

# How often the map is drawn; each picture begins with what rests.
DRAWN_IN_3_S = """async () => {
    let drawn = 0;
    const { context } = document.querySelector("ph-map");
    const draw = context.drawImage;
    context.drawImage = function (...args) { drawn += 1; draw.apply(this, args); };
    await new Promise((resolve) => setTimeout(resolve, 3000));
    delete context.drawImage;
    return drawn;
}"""
# Red of the ground at a corner of the canvas.
CORNER = "document.querySelector('ph-map').context.getImageData(2, 40, 1, 1).data[0]"
# Pins the panels to now, as the timeline does; returns the x of the vehicle then, m.
PIN = """async () => {
    const { emptyState, fold } = await import("/web/js/base/store.js");
    const { vehicle, at, task, system_state } = await new Promise((resolve) => {
        const socket = new WebSocket(`ws://${location.host}/ws`);
        socket.onmessage = ({ data }) => {
            const frame = JSON.parse(data);
            if (frame.type === "state" && frame.vehicle) { socket.close(); resolve(frame); }
        };
    });
    const frame = { type: "state", vehicle, at, task, system_state };
    const detail = { at: Date.parse(at), state: fold(emptyState(), frame) };
    document.dispatchEvent(new CustomEvent("ph-moment", { detail }));
    return vehicle.pose.x_m;
}"""


def shown_middle_m(page: Page) -> tuple[float, float]:
    """Place in the middle of what is shown, m."""
    page.wait_for_timeout(1300)
    found = re.search(r"around x (-?[\d.]+) m, y (-?[\d.]+) m", words(page).inner_text())
    assert found is not None
    return float(found.group(1)), float(found.group(2))


def until(page: Page, function: str, argument: object = None) -> None:
    """Wait until a function of the page holds; Playwright's own way evaluates text in the page."""
    for _ in range(50):
        if page.evaluate(function, argument):
            return
        page.wait_for_timeout(100)
    raise AssertionError(f"it never came: {function}")


def shown_width_m(page: Page) -> float:
    """Width of the part of the world that is shown, m."""
    expect(words(page)).to_contain_text("The map shows")
    page.wait_for_timeout(2000)
    found = re.search(r"The map shows ([\d.]+) m", words(page).inner_text())
    assert found is not None
    return float(found.group(1))


@pytest.fixture
def touch_phone(browser: Browser, service: Service, complaints: Complaints) -> Iterator[Page]:
    context = browser.new_context(
        viewport={"width": 360, "height": 640}, has_touch=True, is_mobile=True
    )
    page = context.new_page()
    complaints.watch(page)
    page.goto(service.url)
    expect(page.get_by_role("heading", level=1)).to_contain_text("IDLE")
    yield page
    context.close()


def test_a_preview_is_drawn_and_gone_when_it_is_discarded(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    picture = "document.querySelector('ph-map canvas').toDataURL()"
    expect(words(desktop)).to_contain_text("Vehicle at")
    open_sheet(desktop)
    desktop.wait_for_timeout(500)
    before = desktop.evaluate(picture)
    choose(desktop, service.track_ahead(30))
    expect(sheet(desktop)).to_contain_text("Preview")
    until(desktop, f"(before) => {picture} !== before", before)
    button(desktop, "Discard").click()
    until(desktop, f"(before) => {picture} === before", before)
    assert complaints.messages == []


def test_keys_and_buttons_move_and_zoom_the_map(desktop: Page, complaints: Complaints) -> None:
    fitted = shown_width_m(desktop)
    canvas(desktop).focus()
    desktop.keyboard.press("+")
    desktop.keyboard.press("+")
    # Told in whole metres.
    assert shown_width_m(desktop) == pytest.approx(fitted / 1.5**2, abs=0.6)
    before = words(desktop).inner_text()
    desktop.keyboard.press("ArrowRight")
    desktop.wait_for_timeout(1300)
    assert words(desktop).inner_text() != before
    desktop.keyboard.press("0")
    assert shown_width_m(desktop) == pytest.approx(fitted)
    expect(button(desktop, "Fit path and vehicle")).to_have_attribute("aria-pressed", "true")
    view = desktop.get_by_role("group", name="Map view")
    view.get_by_role("button", name="Zoom out").click()
    assert shown_width_m(desktop) == pytest.approx(fitted * 1.5, rel=0.02)
    button(desktop, "Follow the vehicle").click()
    expect(button(desktop, "Follow the vehicle")).to_have_attribute("aria-pressed", "true")
    canvas(desktop).hover()
    desktop.mouse.wheel(0, -200)
    assert shown_width_m(desktop) < fitted * 1.5
    expect(button(desktop, "Follow the vehicle")).to_have_attribute("aria-pressed", "true")
    assert complaints.messages == []


def test_a_map_of_a_vehicle_at_rest_is_not_drawn_again(desktop: Page) -> None:
    desktop.wait_for_timeout(500)
    drawn = desktop.evaluate(DRAWN_IN_3_S)
    assert drawn == 0


def test_what_is_drawn_while_it_drives_is_drawn_at_most_ten_times_a_second(
    desktop: Page, service: Service
) -> None:
    start(desktop, service, 60)
    expect(strip(desktop)).to_contain_text(re.compile(r"Speed2\.\d m/s"))
    drawn = desktop.evaluate(DRAWN_IN_3_S)
    assert 5 <= drawn <= 31
    # What a person does is not kept waiting.
    expect(button(desktop, "Fit path and vehicle")).to_have_attribute("aria-pressed", "true")
    hold(button(desktop, "Cancel (hold)"), desktop)


def test_the_map_has_the_colours_of_the_scheme_at_once_when_it_is_switched(desktop: Page) -> None:
    expect(words(desktop)).to_contain_text("Vehicle at")
    light = desktop.evaluate(CORNER)
    desktop.emulate_media(color_scheme="dark")
    until(desktop, f"() => {CORNER} < 60")
    desktop.emulate_media(color_scheme="light")
    until(desktop, f"(light) => {CORNER} === light", light)
    desktop.evaluate("document.documentElement.dataset.theme = 'dark'")
    until(desktop, f"() => {CORNER} < 60")
    assert light > 200


def test_one_finger_moves_the_map_and_two_zoom_it(touch_phone: Page) -> None:
    touch_phone.get_by_role("tab", name="Map").click()
    fitted = shown_width_m(touch_phone)
    box = canvas(touch_phone).bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    session = touch_phone.context.new_cdp_session(touch_phone)

    def touch(kind: str, *points: tuple[float, float]) -> None:
        touches = [{"x": px, "y": py, "id": n} for n, (px, py) in enumerate(points)]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": touches})

    touch("touchStart", (x - 20, y), (x + 20, y))
    for step in range(1, 9):
        touch("touchMove", (x - 20 - 5 * step, y), (x + 20 + 5 * step, y))
    touch("touchEnd")
    assert shown_width_m(touch_phone) == pytest.approx(fitted / 3, rel=0.1)

    middle = shown_middle_m(touch_phone)
    touch("touchStart", (x, y))
    for step in range(1, 11):
        touch("touchMove", (x, y - 12 * step))
    touch("touchEnd")
    moved_m = 120 * shown_width_m(touch_phone) / box["width"]
    assert shown_middle_m(touch_phone)[1] == pytest.approx(middle[1] - moved_m, abs=0.3)
    assert touch_phone.evaluate("scrollY") == 0


def test_a_pinned_moment_shows_the_vehicle_and_the_trail_of_then(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    start(desktop, service, 60)
    expect(strip(desktop)).to_contain_text(re.compile(r"Speed2\.\d m/s"))
    desktop.wait_for_timeout(1500)
    then = words(desktop).inner_text()
    moment = desktop.evaluate(PIN)
    desktop.wait_for_timeout(2500)
    shown = re.search(r"Vehicle at x (-?[\d.]+) m", words(desktop).inner_text())
    assert shown is not None
    assert float(shown.group(1)) == pytest.approx(moment, abs=0.06)
    assert "of 121" in then
    expect(strip(desktop)).to_contain_text("of 121")
    expect(button(desktop, "Pause")).to_be_disabled()
    assert service.pose()["x_m"] - moment > 2
    desktop.evaluate("document.dispatchEvent(new CustomEvent('ph-moment', { detail: null }))")
    expect(button(desktop, "Pause")).to_be_enabled()
    assert complaints.messages == []


def test_an_empty_map_says_what_it_would_show_and_is_as_near_as_the_vehicle_needs(
    desktop: Page, service: Service
) -> None:
    # The path of the last task stays until there is another one.
    service.kill()
    service.start()
    desktop.reload()
    hint = desktop.locator(".map-hint")
    expect(hint).to_be_visible(timeout=10_000)
    expect(hint).to_contain_text("The path of a task, its waypoints and the trail of the vehicle")
    # Of a vehicle alone one sees more than a symbol.
    assert shown_width_m(desktop) < 60


def test_without_contact_the_map_says_of_when_it_is(desktop: Page, service: Service) -> None:
    expect(words(desktop)).to_contain_text("Vehicle at")
    service.kill()
    expect(desktop.locator(".pose-age")).to_have_text(re.compile(r"^pose of \d\d:\d\d:\d\d$"))
    expect(button(desktop, "New task")).to_be_disabled()
    service.start()
    expect(desktop.locator(".pose-age")).to_have_text("", timeout=20_000)
