"""What an operator does with map and task, in a real browser and over the real service."""

import re
from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Locator, Page, expect

from tests.browser.station import Complaints, Service

pytestmark = pytest.mark.browser


def sentence(page: Page) -> Locator:
    return page.get_by_role("heading", level=1)


def panel(page: Page) -> Locator:
    return page.locator("ph-task-panel")


def words(page: Page) -> Locator:
    """What the map tells those who do not see it."""
    return page.locator("#map-words")


def canvas(page: Page) -> Locator:
    return page.locator("ph-map canvas")


def button(page: Page, name: str) -> Locator:
    return page.get_by_role("button", name=name)


def choose(page: Page, content: bytes, name: str = "field.csv") -> None:
    file: Any = {"name": name, "mimeType": "text/csv", "buffer": content}
    page.get_by_label("Choose a CSV").set_input_files(file)


def start(page: Page, service: Service, length_m: int) -> None:
    choose(page, service.track_ahead(length_m))
    page.get_by_role("button", name="Start", exact=True).click()
    expect(sentence(page)).to_contain_text("RUNNING: task ")


def hold(button: Locator, page: Page) -> None:
    button.hover()
    page.mouse.down()
    page.wait_for_timeout(1700)
    page.mouse.up()


def until(page: Page, function: str, argument: object = None) -> None:
    """Wait until a function of the page holds; Playwright's own way evaluates text in the page."""
    for _ in range(50):
        if page.evaluate(function, argument):
            return
        page.wait_for_timeout(100)
    raise AssertionError(f"it never came: {function}")


def shown_width_m(page: Page) -> float:
    """Width of the part of the world that is shown, m."""
    page.wait_for_timeout(1300)
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
    expect(words(page)).to_contain_text("Vehicle at")
    yield page
    context.close()


def test_a_track_is_seen_before_it_is_driven_and_drives_pauses_and_ends_as_asked(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    choose(desktop, service.track_ahead(60))
    expect(panel(desktop)).to_contain_text("Preview of field.csv")
    expect(panel(desktop)).to_contain_text("60 m, 121 waypoints, 0.50 m apart")
    expect(sentence(desktop)).to_have_text("IDLE: no task")

    began = service.pose()
    desktop.get_by_role("button", name="Start", exact=True).click()
    expect(sentence(desktop)).to_have_text(
        re.compile(r"^RUNNING: task t\d+ [1-9]\d? %, waypoint \d+ of 121$"), timeout=15_000
    )
    assert service.pose() != began
    expect(words(desktop)).to_contain_text(re.compile(r"Task t\d+, [1-9]\d? % done"))
    expect(desktop.locator(".readings")).to_contain_text(re.compile(r"Speed[1-9]\.\d m/s"))

    button(desktop, "Pause").click()
    expect(sentence(desktop)).to_have_text(
        re.compile(r"^PAUSED: task t\d+ at \d+ %, held by operator \(paused on the page\)$"),
        timeout=15_000,
    )
    expect(desktop.get_by_role("list", name="Holds")).to_contain_text(
        "operator: paused on the page"
    )
    hold(button(desktop, "Resume (hold)"), desktop)
    expect(sentence(desktop)).to_contain_text("RUNNING")

    hold(button(desktop, "Cancel (hold)"), desktop)
    expect(panel(desktop)).to_contain_text(re.compile(r"Task t\d+ canceled at \d\d:"))
    expect(sentence(desktop)).to_have_text("IDLE: no task")
    assert complaints.messages == []


def test_how_a_task_ended_is_told_also_after_the_page_is_opened_anew(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    start(desktop, service, 6)
    ended = re.compile(r"Task t\d+ succeeded at \d\d:\d\d:\d\d \([56].\d m of 6.0 m in \d")
    expect(panel(desktop)).to_contain_text(ended, timeout=20_000)
    desktop.reload()
    expect(panel(desktop)).to_contain_text(ended)
    assert complaints.messages == []


def test_the_example_drives_at_one_click(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    # It begins where the vehicle is after a start.
    service.kill()
    service.start()
    desktop.reload()
    complaints.messages.clear()
    button(desktop, "Drive the example loop").click()
    expect(sentence(desktop)).to_contain_text("RUNNING: task ")
    expect(button(desktop, "Drive the example loop")).to_be_hidden()
    assert complaints.messages == []


def test_a_track_that_begins_far_away_can_be_begun_where_it_passes_the_vehicle(
    desktop: Page, service: Service
) -> None:
    pose = desktop.request.get(f"{service.url}/vehicle").json()["pose"]
    x, y = pose["x_m"], pose["y_m"]
    passing = "".join(f"{x + step},{y},0\n" for step in range(-20, 21))
    choose(desktop, passing.encode(), "passing.csv")
    button(desktop, "Start").click()
    expect(desktop.locator("ph-task-form").get_by_role("alert")).to_contain_text("begins 20.0 m")
    button(desktop, "Start at waypoint 21").click()

    expect(sentence(desktop)).to_contain_text("RUNNING: task ")


def test_a_refused_file_shows_the_line_and_starts_nothing(desktop: Page, service: Service) -> None:
    choose(desktop, b"0,0,0\n1,0,0\n2,zwei<b>,0\n3,0,0\n", "bad.csv")
    alert = desktop.locator("ph-task-form").get_by_role("alert")
    expect(alert).to_contain_text("Rejected: ")
    expect(alert).to_contain_text("Line 3")
    expect(alert.locator("code")).to_have_text("2,zwei<b>,0")
    expect(button(desktop, "Start")).to_be_hidden()
    button(desktop, "Discard").click()
    expect(alert).to_be_hidden()


def test_a_preview_is_drawn_and_gone_when_it_is_discarded(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    picture = "document.querySelector('ph-map canvas').toDataURL()"
    expect(words(desktop)).to_contain_text("Vehicle at")
    desktop.wait_for_timeout(300)
    before = desktop.evaluate(picture)
    choose(desktop, service.track_ahead(30))
    expect(panel(desktop)).to_contain_text("Preview of field.csv")
    until(desktop, f"(before) => {picture} !== before", before)
    button(desktop, "Discard").click()
    until(desktop, f"(before) => {picture} === before", before)
    assert complaints.messages == []


def test_an_empty_file_is_refused_in_words(desktop: Page) -> None:
    choose(desktop, b"", "empty.csv")
    expect(desktop.locator("ph-task-form").get_by_role("alert")).to_contain_text("Rejected: ")


def test_a_preview_tells_how_the_columns_were_read(desktop: Page, service: Service) -> None:
    rows = service.track_ahead(30).decode().replace(",", "; ").replace("\n", "\r")
    choose(desktop, ("\ufeffX [m]; Y [m]; yaw\r" + rows).encode("utf-16-le"))
    expect(panel(desktop)).to_contain_text(
        "Semicolon-separated, named in line 1: x from X [m] (column 1), y from Y [m] (column 2),"
        " heading from yaw (column 3), radians counter-clockwise from east"
    )
    expect(desktop.get_by_label("Headings in")).to_be_hidden()


def test_a_column_that_is_no_heading_is_asked_about_and_can_be_left_out(
    desktop: Page, service: Service
) -> None:
    heading, columns = desktop.get_by_label("Headings in"), desktop.get_by_label("Columns")
    expect(heading).to_be_hidden()
    choose(desktop, service.track_ahead(30, scans=True))
    expect(panel(desktop)).to_contain_text("the third column fits the path as a heading in no unit")
    expect(heading).to_be_visible()
    button(desktop, "Start").click()
    expect(desktop.locator("ph-task-form").get_by_role("alert")).to_contain_text("no unit")
    columns.fill("x,y")
    columns.blur()
    expect(panel(desktop)).to_contain_text("headings from the path")
    expect(panel(desktop)).not_to_contain_text("in no unit")
    expect(desktop.get_by_role("button", name="Start", exact=True)).to_be_enabled()


def test_a_file_dropped_on_the_map_is_previewed(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    transfer = desktop.evaluate_handle(
        """(text) => {
            const transfer = new DataTransfer();
            transfer.items.add(new File([text], "dropped.csv", { type: "text/csv" }));
            return transfer;
        }""",
        service.track_ahead(20).decode(),
    )
    canvas(desktop).dispatch_event("dragover", {"dataTransfer": transfer})
    canvas(desktop).dispatch_event("drop", {"dataTransfer": transfer})
    expect(panel(desktop)).to_contain_text("Preview of dropped.csv")
    expect(sentence(desktop)).to_have_text("IDLE: no task")
    assert complaints.messages == []


def test_an_error_pauses_the_task_and_the_page_says_why_and_who_may_let_go(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    start(desktop, service, 60)
    service.request("PATCH", "/mock/battery_level", {"value": 0.1})
    expect(sentence(desktop)).to_have_text(
        re.compile(r"^ERROR: battery 10 % is below 50 %, task t\d+ is paused$")
    )
    holds = desktop.get_by_role("list", name="Holds")
    expect(holds).to_contain_text("error")
    expect(holds.get_by_role("button")).to_have_count(0)
    service.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    expect(holds).to_contain_text("gate: the gate is shut")
    hold(button(desktop, "Release gate (hold)"), desktop)
    expect(holds).not_to_contain_text("gate")
    service.request("PATCH", "/mock/battery_level", {"value": 0.9})
    expect(sentence(desktop)).to_contain_text("RUNNING: task ")
    assert complaints.messages == []


def test_keys_and_buttons_move_and_zoom_the_map(desktop: Page, complaints: Complaints) -> None:
    fitted = shown_width_m(desktop)
    canvas(desktop).focus()
    desktop.keyboard.press("+")
    desktop.keyboard.press("+")
    assert shown_width_m(desktop) == pytest.approx(fitted / 1.5**2, rel=0.02)
    before = words(desktop).inner_text()
    desktop.keyboard.press("ArrowRight")
    desktop.wait_for_timeout(1300)
    assert words(desktop).inner_text() != before
    desktop.keyboard.press("0")
    assert shown_width_m(desktop) == pytest.approx(fitted)
    expect(button(desktop, "Fit path and vehicle")).to_have_attribute("aria-pressed", "true")
    button(desktop, "Zoom out").click()
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
    drawn = desktop.evaluate(
        """async () => {
            let drawn = 0;
            const { context } = document.querySelector("ph-map");
            const fill = context.fillRect;
            context.fillRect = function (...args) { drawn += 1; fill.apply(this, args); };
            await new Promise((resolve) => setTimeout(resolve, 1500));
            delete context.fillRect;
            return drawn;
        }"""
    )
    assert drawn == 0


def test_on_a_phone_a_driven_task_leaves_everything_reachable(
    phone: Page, service: Service, complaints: Complaints
) -> None:
    choose(phone, service.track_ahead(60))
    expect(panel(phone)).to_contain_text("Preview of field.csv")
    assert phone.evaluate("document.documentElement.scrollWidth") == 360
    phone.get_by_role("button", name="Start", exact=True).click()
    expect(sentence(phone)).to_contain_text("RUNNING: task ")
    assert phone.evaluate("document.documentElement.scrollWidth") == 360
    box = canvas(phone).bounding_box()
    assert box is not None
    assert box["height"] >= 260
    button(phone, "Pause").click()
    expect(button(phone, "Resume")).to_be_visible()
    expect(button(phone, "STOP")).to_be_in_viewport(ratio=1)
    small = phone.evaluate(
        """() => [...document.querySelectorAll("button, select, input:not([type=file]), summary")]
            .filter((node) => node.checkVisibility() && !node.closest("label.switch"))
            .filter((node) => node.getBoundingClientRect().height < 44)
            .map((node) => node.outerHTML)"""
    )
    assert small == []
    assert complaints.messages == []


def test_one_finger_scrolls_the_page_and_two_zoom_the_map(touch_phone: Page) -> None:
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
    assert touch_phone.evaluate("scrollY") == 0

    touch("touchStart", (x, y))
    for step in range(1, 11):
        touch("touchMove", (x, y - 12 * step))
    touch("touchEnd")
    until(touch_phone, "() => scrollY > 50")


def test_without_contact_the_map_says_of_when_it_is(desktop: Page, service: Service) -> None:
    expect(words(desktop)).to_contain_text("Vehicle at")
    service.kill()
    expect(desktop.locator(".pose-age")).to_have_text(re.compile(r"^pose of \d\d:\d\d:\d\d$"))
    expect(desktop.get_by_label("Choose a CSV")).to_be_disabled()
    service.start()
    expect(desktop.locator(".pose-age")).to_have_text("", timeout=20_000)
