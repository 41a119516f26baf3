"""What an operator does with the page, in a real browser and over the real service."""

import re
import time
from urllib.parse import urlsplit

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Locator, Page, expect

from tests.browser.places import sentence, stop
from tests.browser.station import Complaints, Service

pytestmark = pytest.mark.browser


def row(page: Page, part: str) -> Locator:
    return page.get_by_role("treeitem", name=re.compile(f"^{part} "))


def hold(button: Locator, page: Page, milliseconds: int) -> None:
    button.hover()
    page.mouse.down()
    page.wait_for_timeout(milliseconds)
    page.mouse.up()


def open_log(page: Page) -> None:
    page.get_by_role("tab", name="Log", exact=True).click()


def test_the_page_says_what_the_robot_is_in_and_what_of_it_is_not_real(
    desktop: Page, complaints: Complaints
) -> None:
    expect(sentence(desktop)).to_have_text("IDLE: no task")
    badge = desktop.get_by_text("SIMULATED", exact=True)
    expect(badge).to_be_visible()
    expect(badge).to_have_attribute("title", "Simulated: nodes, signals, vehicle")
    expect(row(desktop, "actuation")).to_have_attribute("aria-expanded", "true")
    expect(row(desktop, "drive_base")).to_be_visible()
    assert complaints.messages == []


def test_a_system_changes_its_mode_and_both_nodes_follow(
    desktop: Page, complaints: Complaints
) -> None:
    desktop.get_by_role("radio", name="PERFORMANCE").click()
    expect(row(desktop, "drive_base")).to_contain_text("active.FAST", timeout=15_000)
    expect(row(desktop, "manipulator")).to_contain_text("active.STRONG", timeout=15_000)
    expect(row(desktop, "actuation")).to_contain_text("active.PERFORMANCE (*)")
    expect(desktop.locator("ph-change")).to_contain_text("succeeded after")
    assert complaints.messages == []


def test_of_two_changes_of_a_part_the_panel_shows_the_newer(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    for mode in ("PERFORMANCE", "MODERATE"):
        service.request("POST", "/systems/actuation/mode?wait=15", {"mode": mode})
    desktop.reload()
    expect(desktop.locator("ph-change")).to_contain_text("mode MODERATE, requested at")
    expect(desktop.locator("ph-change")).to_contain_text("succeeded after")
    assert complaints.messages == []


def test_the_changes_that_others_ask_for_are_shown_at_few_requests(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    change = desktop.locator("ph-change")
    expect(desktop.get_by_role("radio", name="MODERATE")).to_be_enabled()
    asked: list[str] = []
    desktop.on("request", lambda request: asked.append(urlsplit(request.url).path))
    begin = time.monotonic()
    for transition in ("cleanup", "configure", "activate"):
        path = "/systems/actuation/state?wait=15"
        service.request("POST", path, {"transition": transition})
        expect(change).to_contain_text(f"{transition}, requested at")
        expect(change).to_contain_text("succeeded after")
    desktop.wait_for_timeout(1000)
    seconds = time.monotonic() - begin
    assert asked.count("/systems") == asked.count("/nodes") == 0
    assert 3 <= asked.count("/systems/actuation/state") <= 2 * seconds + 1
    assert complaints.messages == []


def test_holds_the_stop_and_the_end_of_a_task_of_others_are_shown_without_a_question(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    expect(desktop.get_by_role("radio", name="MODERATE")).to_be_enabled()
    asked: list[str] = []
    desktop.on("request", lambda request: asked.append(urlsplit(request.url).path))
    service.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    expect(desktop.get_by_role("list", name="Holds")).to_contain_text("the gate is shut")
    service.request("DELETE", "/holds/gate")
    expect(desktop.get_by_role("list", name="Holds")).to_be_hidden()
    service.request("PUT", "/emergency_stop", {"engaged": True, "reason": "smoke"})
    expect(desktop.locator("ph-stop-release")).to_contain_text("smoke")
    service.request("PUT", "/emergency_stop", {"engaged": False, "reason": "clear"})
    expect(stop(desktop)).to_have_text("STOP")
    open_log(desktop)
    events = desktop.get_by_role("list", name="Recent events")
    expect(events).to_contain_text("hold gate set: the gate is shut")
    known = {"/holds", "/emergency_stop", "/systems", "/nodes", "/tasks", "/events"}
    assert known.isdisjoint(asked)
    assert complaints.messages == []


def test_details_are_left_out_of_the_events_until_they_are_asked_for(
    desktop: Page, service: Service
) -> None:
    service.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    open_log(desktop)
    events = desktop.get_by_role("list", name="Recent events")
    expect(events).to_contain_text("hold gate set: the gate is shut")
    detail = events.locator('[data-kind="audit.write"]')
    expect(detail).to_have_count(0)
    desktop.get_by_role("switch", name="Show details").check()
    expect(detail).not_to_have_count(0)


def test_stop_engages_at_one_press_and_only_a_long_press_releases_it(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    # Under ESTOP nothing is activated; a mode of what is active already can be entered still.
    service.request("POST", "/systems/actuation/state?wait=15", {"transition": "cleanup"})
    stop(desktop).click()
    expect(stop(desktop)).to_contain_text("ENGAGED")
    expect(sentence(desktop)).to_contain_text("ERROR")
    moderate = desktop.locator(".mode").filter(has_text="MODERATE")
    expect(moderate.get_by_role("radio")).to_be_disabled()
    expect(moderate.locator(".blocker")).not_to_be_empty()
    release = desktop.get_by_role("button", name="Release the stop (hold)")
    hold(release, desktop, 400)
    desktop.wait_for_timeout(1300)
    expect(stop(desktop)).to_contain_text("ENGAGED")
    hold(release, desktop, 1700)
    expect(stop(desktop)).to_have_text("STOP")
    expect(sentence(desktop)).to_have_text("IDLE: no task")
    assert complaints.messages == []


def test_all_of_it_works_from_the_keyboard(desktop: Page, complaints: Complaints) -> None:
    row(desktop, "actuation").focus()
    desktop.keyboard.press("ArrowDown")
    desktop.keyboard.press("Home")
    expect(row(desktop, "actuation")).to_be_focused()
    desktop.keyboard.press("d")
    desktop.keyboard.press("Enter")
    expect(row(desktop, "drive_base")).to_have_attribute("aria-selected", "true")
    expect(desktop.get_by_role("radio", name="FAST")).to_be_visible()
    desktop.keyboard.press("ArrowLeft")
    desktop.keyboard.press("ArrowLeft")
    expect(row(desktop, "drive_base")).to_have_count(0)
    desktop.keyboard.press("ArrowRight")
    expect(row(desktop, "drive_base")).to_be_visible()
    stop(desktop).focus()
    desktop.keyboard.press("Enter")
    expect(stop(desktop)).to_contain_text("ENGAGED")
    desktop.get_by_role("button", name="Release the stop (hold)").focus()
    desktop.keyboard.down(" ")
    desktop.wait_for_timeout(1700)
    desktop.keyboard.up(" ")
    expect(stop(desktop)).to_have_text("STOP")
    assert complaints.messages == []


def test_a_refused_request_is_shown_in_words(desktop: Page, service: Service) -> None:
    mode = desktop.get_by_role("radio", name="MODERATE")
    expect(mode).to_be_enabled()
    refusal = {
        "title": "Refused",
        "status": 409,
        "code": "BLOCKED",
        "detail": "actuation cannot be changed: <b>manipulator</b> is finalized",
        "hint": "restart the node",
    }
    desktop.route(
        "**/systems/actuation/mode", lambda route: route.fulfill(status=409, json=refusal)
    )
    mode.click()
    alert = desktop.locator("ph-change").get_by_role("alert")
    # As text: markup from the network stays text.
    expect(alert).to_contain_text("<b>manipulator</b> is finalized")
    expect(alert).to_contain_text("Hint: restart the node")


def test_a_phone_shows_stop_wherever_one_scrolls_and_never_scrolls_sideways(
    phone: Page, service: Service, complaints: Complaints
) -> None:
    service.request("PATCH", "/mock/battery_level", {"value": 0.1})
    service.request("PATCH", "/mock/temperature", {"value": 90})
    stop(phone).click()
    expect(sentence(phone)).to_contain_text("ERROR")
    assert phone.evaluate("document.documentElement.scrollWidth") == 360
    for end in ("0", "10000"):
        phone.evaluate(f"document.querySelector('main').scrollTo(0, {end})")
        expect(stop(phone)).to_be_in_viewport(ratio=1)
        expect(sentence(phone)).to_be_in_viewport()
    box = stop(phone).bounding_box()
    assert box is not None
    assert min(box["width"], box["height"]) >= 64
    assert complaints.messages == []


def test_buttons_and_inputs_are_large_enough_for_a_thumb(phone: Page) -> None:
    targets = "button, select, input[type=range], label, .row"
    script = f"""() => [...document.querySelectorAll("{targets}")]
        .filter((node) => node.checkVisibility() && node.getBoundingClientRect().height < 44)
        .map((node) => node.outerHTML)"""
    for tab in ("Status", "Parts", "Signals"):
        phone.get_by_role("tab", name=tab).click()
        expect(phone.get_by_role("tab", name=tab)).to_have_attribute("aria-selected", "true")
        assert phone.evaluate(script) == []
    phone.get_by_role("tab", name="Parts").click()
    row(phone, "actuation").click()
    expect(phone.get_by_role("radio", name="PERFORMANCE")).to_be_visible()
    assert phone.evaluate(script) == []


def test_a_killed_service_leaves_no_contact_and_a_stop_that_is_delivered_when_it_is_back(
    desktop: Page, service: Service
) -> None:
    expect(desktop.get_by_role("radio", name="MODERATE")).to_be_enabled()
    service.kill()
    expect(sentence(desktop)).to_have_text(
        re.compile(r"^No contact for \d s: values shown are from \d\d:\d\d:\d\d$")
    )
    expect(desktop.get_by_role("radio", name="MODERATE")).to_be_disabled()
    stop(desktop).click()
    status = desktop.locator("ph-stop-button")
    expect(status).to_contain_text("Not delivered. Use the hardware stop.")
    service.start()
    # Not `click()`: by chance the page may just have come back by itself.
    desktop.get_by_text("Try now").dispatch_event("click")
    expect(desktop.locator("ph-state-bar .contact")).to_contain_text("Connected", timeout=10_000)
    expect(stop(desktop)).to_contain_text("ENGAGED")
    expect(sentence(desktop)).to_contain_text("ERROR")
    open_log(desktop)
    expect(desktop.get_by_role("list", name="Recent events")).to_contain_text("restarted")
    notice = desktop.locator("ph-notices .notice")
    expect(notice).to_contain_text(
        re.compile(r"Started again at \d\d:\d\d:\d\d; it remembers nothing: earlier tasks")
    )
    notice.get_by_role("button", name="Dismiss").click()
    expect(notice).to_be_hidden()
    assert service.request("GET", "/emergency_stop")["engaged"] is True
