"""The selected part, as an operator reads it and changes it: by mouse, by key, on a phone."""

import re
from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Locator, Page, Route, expect

from tests.browser.robots import large_robot
from tests.browser.station import Complaints, Service, serving
from tests.browser.test_operator import opened

pytestmark = pytest.mark.browser

SYSTEM = "/systems/actuation"
SLOW_MS = 15_000


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    folder = tmp_path_factory.mktemp("large")
    with serving(folder, large_robot(folder)) as service:
        yield service


@pytest.fixture
def unconfigured(service: Service) -> Service:
    service.request("POST", f"{SYSTEM}/state?wait=15", {"transition": "cleanup"})
    return service


def panel(page: Page) -> Locator:
    return page.locator("ph-part-panel")


def radio(page: Page, name: str) -> Locator:
    return panel(page).get_by_role("radiogroup", name="Mode").get_by_role("radio", name=name)


def select(page: Page, name: str) -> None:
    page.get_by_role("treeitem").filter(has_text=name).last.click()
    expect(panel(page).get_by_role("heading", level=2)).to_have_text(name)


# --- modes ---------------------------------------------------------------------------------------


def test_few_modes_are_one_control_that_marks_the_target_and_the_actual_one(
    desktop: Page, unconfigured: Service, complaints: Complaints
) -> None:
    boxes = [radio(desktop, name).bounding_box() for name in ("default", "MODERATE", "PERFORMANCE")]
    assert len({box["y"] for box in boxes if box}) == 1
    radio(desktop, "PERFORMANCE").click()
    expect(radio(desktop, "PERFORMANCE")).to_have_text(re.compile("target|actual"))
    expect(radio(desktop, "PERFORMANCE")).to_be_checked(timeout=SLOW_MS)
    expect(radio(desktop, "PERFORMANCE")).to_have_text("PERFORMANCEactual")
    expect(radio(desktop, "default")).not_to_be_checked()
    assert complaints.messages == []


def test_with_keys_alone_a_mode_is_switched_in_few_presses_and_moving_sends_nothing(
    desktop: Page, unconfigured: Service
) -> None:
    del unconfigured
    radio(desktop, "MODERATE").wait_for()
    presses = ["Tab", "Tab", "Enter"]
    for key in presses:
        desktop.keyboard.press(key)
    while not desktop.evaluate("document.activeElement.role === 'radio'"):
        presses.append("Tab")
        desktop.keyboard.press("Tab")
        assert len(presses) < 10
    posted: list[str] = []
    desktop.on(
        "request", lambda sent: posted.append(sent.method) if sent.method == "POST" else None
    )
    desktop.keyboard.press("ArrowRight")
    expect(radio(desktop, "MODERATE")).to_be_focused()
    assert posted == []
    desktop.keyboard.press("Space")
    expect(radio(desktop, "MODERATE")).to_be_checked(timeout=SLOW_MS)
    assert len(presses) + 2 <= 12


def test_a_press_on_a_mode_that_cannot_be_entered_opens_why_not(
    desktop: Page, unconfigured: Service
) -> None:
    unconfigured.request("PATCH", "/mock/estop", {"value": True})
    expect(radio(desktop, "MODERATE")).to_be_disabled()
    radio(desktop, "MODERATE").click(force=True)
    expect(panel(desktop).locator(".mode .reason-tree").first).to_contain_text("e-stop is pressed")
    assert unconfigured.request("GET", SYSTEM)["change"] is None


def test_more_modes_than_fit_beside_each_other_are_a_list(desktop: Page) -> None:
    expect(radio(desktop, "MODERATE")).to_be_visible()
    columns = desktop.evaluate(
        """() => [2, 3, 4, 5].map((count) => {
            const shown = document.createElement("ph-mode-switcher");
            document.body.append(shown);
            const mode = (index) => `MODE_${index}`;
            const modes = Array.from({ length: count }, (_, index) => ({
                mode: mode(index), can_enter: true, can_stay: null, blockers: [],
            }));
            const actual = { state: "active", mode: "MODE_1" };
            const part = { name: "base", kind: "node", actual, target: actual };
            shown.show({ part, modes, enabled: true, isLive: true, signals: {} });
            return shown.querySelector(".modes").dataset.columns;
        })"""
    )
    assert columns == ["2", "3", "4", "1"]


# --- parameters and lifecycle --------------------------------------------------------------------


def test_parameters_that_are_not_as_wanted_come_first(desktop: Page, unconfigured: Service) -> None:
    unconfigured.request("POST", f"{SYSTEM}/mode?wait=15", {"mode": "PERFORMANCE"})
    select(desktop, "drive_base")
    parameters = panel(desktop).locator("ph-parameters")
    expect(parameters.locator("summary")).to_have_text("Parameters 2")
    unconfigured.request("PATCH", "/nodes/drive_base/parameters?wait=15", {"max_speed": 0.4})
    expect(parameters.locator("summary")).to_have_text("Parameters 2, 1 not as wanted")
    parameters.locator("summary").click()
    first = parameters.locator("tbody tr").first
    expect(first).to_have_text("max_speed0.40.9")
    expect(first.get_by_role("rowheader")).to_have_attribute("title", "max_speed")


def test_a_system_has_no_parameters(desktop: Page, service: Service) -> None:
    del service
    expect(radio(desktop, "MODERATE")).to_be_visible()
    expect(panel(desktop).locator("ph-parameters")).to_be_hidden()


def test_transitions_are_folded_and_shutdown_wants_a_long_press(
    desktop: Page, unconfigured: Service
) -> None:
    del unconfigured
    configure = panel(desktop).get_by_role("button", name="configure")
    expect(configure).to_be_hidden()
    panel(desktop).locator("ph-lifecycle summary").click()
    expect(configure).to_be_enabled()
    expect(panel(desktop).get_by_role("button", name="shutdown (hold)")).to_be_visible()
    configure.click()
    expect(panel(desktop).locator(".change")).to_contain_text("configure, requested at")


# --- the last change -----------------------------------------------------------------------------


def test_the_end_of_a_change_stays_until_it_is_dismissed(
    desktop: Page, unconfigured: Service
) -> None:
    del unconfigured
    radio(desktop, "MODERATE").click()
    change = panel(desktop).locator(".change")
    expect(change).to_contain_text("succeeded after", timeout=SLOW_MS)
    select(desktop, "drive_base")
    select(desktop, "actuation")
    expect(change).to_contain_text("succeeded after")
    change.get_by_role("button", name="Dismiss").click()
    expect(change).to_be_hidden()
    select(desktop, "drive_base")
    select(desktop, "actuation")
    expect(radio(desktop, "MODERATE")).to_be_checked()
    expect(change).to_be_hidden()


def test_a_large_change_shows_a_count_and_what_failed_and_not_each_step(desktop: Page) -> None:
    step: dict[str, Any] = {
        "action": "activate", "started_at": None, "ended_at": None, "error": None,
        "stage": 0, "after": [], "expected_s": 0.2, "rollback": False,
    }  # fmt: skip
    statuses = ["succeeded"] * 400 + ["failed"] * 20 + ["running"] * 30 + ["pending"] * 550
    steps = [
        {**step, "node": f"node_{number}", "status": status, "error": status[:1]}
        for number, status in enumerate(statuses)
    ]
    words, items = desktop.evaluate(
        """async (steps) => {
            const { areMany, notableSteps } = await import("/web/js/base/step_list.js");
            const shown = document.createElement("div");
            shown.append(...notableSteps(steps, 0));
            return [areMany(steps) && shown.textContent, shown.querySelectorAll("li").length];
        }""",
        steps,
    )
    assert "node_400: activate" in words
    assert "and 8 more failed" in words
    assert "Stage 1: 400 of 1000 steps" in words
    assert items == 12 + 3 + 1


def test_a_change_of_a_hundred_nodes_is_told_as_a_count(browser: Browser, large: Service) -> None:
    page = opened(browser, large, 1440, 900)
    panel(page).locator("ph-lifecycle").wait_for()
    large.request("POST", "/nodes/node_001/state", {"transition": "configure"})
    root = large.request("GET", "/systems")["items"][0]["name"]
    large.request("POST", f"/systems/{root}/mode", {"mode": "__DEFAULT__"})
    change = panel(page).locator(".change")
    expect(change).to_contain_text(re.compile(r"\d+ of \d{3} steps"), timeout=SLOW_MS)
    assert change.locator("li").count() < 20
    page.close()


# --- a moment, and no contact --------------------------------------------------------------------


def test_pinned_to_a_moment_a_part_is_shown_as_it_was_and_nothing_can_be_sent(
    desktop: Page, unconfigured: Service
) -> None:
    unconfigured.request("POST", f"{SYSTEM}/mode?wait=15", {"mode": "MODERATE"})
    expect(radio(desktop, "MODERATE")).to_be_checked()
    asked: list[str] = []
    desktop.on("request", lambda sent: asked.append(sent.url))
    desktop.evaluate(
        """async () => {
            const { emptyState } = await import("/web/js/base/store.js");
            const actual = { state: "active", mode: "PERFORMANCE", inferred: false };
            const blockers = [{ message: "it was too hot then", path: [], causes: [] }];
            const target = { state: "active", mode: "MODERATE" };
            const because = { because: "invariant", rule: null, blockers };
            const effective = { state: "active", mode: "PERFORMANCE", ...because };
            const part = { name: "actuation", kind: "system", parts: [], target, actual,
                effective_target: effective, converged: true, reachable: true, change: null };
            const at = "2026-05-04T12:00:00.000Z";
            const state = { ...emptyState(), at, parts: { actuation: part } };
            const detail = { at: Date.parse(at), state };
            document.dispatchEvent(new CustomEvent("ph-moment", { detail }));
        }"""
    )
    expect(radio(desktop, "PERFORMANCE")).to_be_checked()
    expect(radio(desktop, "PERFORMANCE")).to_contain_text("was actual")
    for name in ("MODERATE", "default"):
        expect(radio(desktop, name)).to_be_disabled()
    why = panel(desktop).locator("ph-part-why")
    why.locator("summary").click()
    expect(why).to_contain_text("it was too hot then")
    assert not [url for url in asked if url.endswith("/why")]
    desktop.evaluate("document.dispatchEvent(new CustomEvent('ph-moment', { detail: null }))")
    expect(radio(desktop, "MODERATE")).to_be_checked()
    expect(radio(desktop, "PERFORMANCE")).to_be_enabled()


# --- a phone -------------------------------------------------------------------------------------


def test_on_a_phone_a_part_opens_in_place_of_the_list_and_back_returns_to_its_row(
    phone: Page, service: Service
) -> None:
    del service
    phone.get_by_role("tab", name="Parts").click()
    row = phone.get_by_role("treeitem").filter(has_text="drive_base").last
    row.click()
    heading = panel(phone).get_by_role("heading", level=2)
    expect(heading).to_have_text("drive_base")
    expect(heading).to_be_focused()
    expect(heading).to_be_in_viewport()
    expect(row).to_be_hidden()
    expect(radio(phone, "FAST")).to_be_in_viewport()
    panel(phone).get_by_role("button", name="Back").click()
    expect(heading).to_be_hidden()
    expect(row).to_be_focused()


def test_a_part_that_is_selected_before_its_panel_is_there_gets_the_focus_when_it_is(
    browser: Browser, service: Service
) -> None:
    page = browser.new_page(viewport={"width": 360, "height": 640})
    # It stays away until the press, as on a slow link.
    waiting: list[Route] = []
    page.route("**/panels.js", lambda route: waiting.append(route))
    page.goto(service.url)
    page.get_by_role("tab", name="Parts").click()
    page.get_by_role("treeitem").filter(has_text="drive_base").last.click()
    waiting[0].continue_()
    heading = panel(page).get_by_role("heading", level=2)
    expect(heading).to_have_text("drive_base")
    expect(heading).to_be_focused()
    page.close()


def test_on_a_phone_the_gesture_for_back_closes_the_part(phone: Page, service: Service) -> None:
    del service
    phone.get_by_role("tab", name="Parts").click()
    phone.get_by_role("treeitem").filter(has_text="drive_base").last.click()
    expect(panel(phone)).to_be_visible()
    phone.go_back()
    expect(panel(phone)).to_be_hidden()
    expect(phone.get_by_role("heading", level=1)).to_contain_text("IDLE")


def test_on_a_phone_who_comes_from_an_error_goes_back_to_it(phone: Page, service: Service) -> None:
    service.request("POST", f"{SYSTEM}/mode?wait=15", {"mode": "MODERATE"})
    phone.evaluate(
        "document.dispatchEvent(new CustomEvent('ph-select', { detail: 'manipulator' }))"
    )
    expect(panel(phone).get_by_role("heading", level=2)).to_have_text("manipulator")
    panel(phone).get_by_role("button", name="Back").click()
    expect(phone.locator("ph-why")).to_be_visible()
    expect(panel(phone)).to_be_hidden()


def test_what_is_pressed_on_a_phone_is_large_enough(phone: Page, service: Service) -> None:
    del service
    phone.get_by_role("tab", name="Parts").click()
    phone.get_by_role("treeitem").filter(has_text="drive_base").last.click()
    expect(radio(phone, "FAST")).to_be_visible()
    panel(phone).locator("ph-lifecycle summary").click()
    small = panel(phone).evaluate(
        """(panel) => [...panel.querySelectorAll("button, label, select, summary")]
             .filter((node) => node.checkVisibility() && node.getBoundingClientRect().height < 44)
             .map((node) => node.outerHTML)"""
    )
    assert small == []
    assert phone.evaluate("document.documentElement.scrollWidth") <= 360
