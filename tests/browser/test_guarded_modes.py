"""Modes with guards and an order on the page: why not, what would happen, and what happens."""

from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Locator, Page, Request, expect

from tests.browser.robots import LONG, guarded_robot
from tests.browser.station import Service, serving
from tests.browser.test_operator import BROKEN_WORDS, opened

pytestmark = pytest.mark.browser

SYSTEM = "/systems/mobile_manipulation"
SLOW_MS = 15_000


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    folder = tmp_path_factory.mktemp("guarded")
    with serving(folder, guarded_robot(folder)) as service:
        yield service


@pytest.fixture(scope="module")
def failing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    folder = tmp_path_factory.mktemp("failing")
    with serving(folder, guarded_robot(folder, "fail")) as service:
        yield service


@pytest.fixture
def service(guarded: Service) -> Service:
    guarded.make_healthy()
    guarded.request("POST", f"{SYSTEM}/state?wait=15", {"transition": "cleanup"})
    return guarded


@pytest.fixture
def desktop(browser: Browser, service: Service) -> Iterator[Page]:
    page = opened(browser, service, 1280, 800)
    yield page
    page.close()


def mode(page: Page, name: str) -> Locator:
    return page.locator(".mode").filter(has=page.get_by_role("radio", name=name))


def change(page: Page) -> Locator:
    return page.locator("ph-change .change")


def drain(service: Service) -> None:
    """Let the battery be too low for MANIPULATE."""
    service.request("PATCH", "/mock/battery_level", {"value": 0.21})


# --- why not -------------------------------------------------------------------------------------


def test_a_mode_that_cannot_be_entered_says_the_nearest_reason_until_it_is_gone(
    desktop: Page, service: Service
) -> None:
    drain(service)
    manipulate = mode(desktop, "MANIPULATE")
    expect(manipulate.locator(".blocker")).to_have_text("Battery is 0.21, needs >= 0.3")
    expect(manipulate.get_by_role("radio")).to_be_disabled()
    # A reading changes neither a part nor an event of it.
    service.request("PATCH", "/mock/battery_level", {"value": 0.9})
    expect(manipulate.get_by_role("radio")).to_be_enabled()
    expect(manipulate.locator(".blocker")).to_be_empty()


def test_the_whole_tree_opens_by_keyboard_and_names_root_causes_and_conditions(
    desktop: Page, service: Service
) -> None:
    drain(service)
    manipulate = mode(desktop, "MANIPULATE")
    summary = manipulate.locator("summary")
    expect(summary).to_contain_text("Why not MANIPULATE")
    summary.focus()
    desktop.keyboard.press("Enter")
    tree = manipulate.locator(".reason-tree").first
    expect(tree).to_contain_text("not met: battery_level >= 0.3 and (arm.state != finalized")
    inner = tree.locator(".reason-tree li")
    expect(inner).to_contain_text("Battery is 0.21, needs >= 0.3")
    expect(inner.locator(".root")).to_have_text("root cause")
    expect(tree.locator(".root")).to_have_count(1)
    expect(manipulate.locator(".conditions").nth(0)).to_contain_text("drive_base.reachable")
    expect(manipulate.locator(".conditions").nth(1)).to_have_text("temperature < 50")


def test_conditions_that_hold_can_be_read_and_a_mode_without_any_has_nothing_to_open(
    desktop: Page,
) -> None:
    expect(mode(desktop, "TRANSPORT").locator("summary")).to_have_text("Conditions of TRANSPORT")
    expect(mode(desktop, "TRANSPORT").get_by_role("radio")).to_be_enabled()
    expect(mode(desktop, "CAREFUL").locator("summary")).to_be_hidden()


@pytest.mark.parametrize(("width", "height"), [(360, 640), (800, 700), (1280, 800)])
def test_trees_and_plans_fit_beside_a_long_name(
    browser: Browser, failing: Service, width: int, height: int
) -> None:
    failing.make_healthy()
    page = opened(browser, failing, width, height)
    failing.request("POST", f"{SYSTEM}/mode", {"mode": "CAREFUL"})
    expect(change(page)).to_contain_text("failed after", timeout=SLOW_MS)
    if width < 1024:
        page.get_by_role("tab", name="Parts").click()
        page.get_by_role("treeitem").filter(has_text="mobile_manipulation").first.click()
    page.get_by_label("Plan first").check()
    page.get_by_role("radio", name="TRANSPORT").click()
    expect(page.locator("ph-plan")).to_contain_text(LONG)
    drain(failing)
    mode(page, "MANIPULATE").locator("summary").click()
    page.locator("ph-part-why summary").click()
    expect(page.locator("ph-part-why .reason-tree")).to_contain_text(LONG)
    assert page.evaluate(BROKEN_WORDS) == []
    assert page.evaluate("document.documentElement.scrollWidth") == width
    page.close()


# --- the plan ------------------------------------------------------------------------------------


def test_a_plan_is_shown_by_stage_before_it_is_applied(desktop: Page, service: Service) -> None:
    service.request("POST", f"{SYSTEM}/mode?wait=15", {"mode": "MANIPULATE"})
    service.request("POST", f"{SYSTEM}/state?wait=15", {"transition": "cleanup"})
    desktop.get_by_label("Plan first").check()
    mode(desktop, "MANIPULATE").get_by_role("radio").click()
    plan = desktop.locator("ph-plan")
    heading = plan.get_by_role("heading", name="Plan: mode MANIPULATE of mobile_manipulation")
    expect(heading).to_be_focused()
    expect(heading).to_be_in_viewport()
    expect(plan).to_contain_text("2 stages, about ")
    expect(plan.get_by_role("list").nth(0)).to_contain_text("drive_base: activate")
    expect(plan.get_by_role("list").nth(1)).to_contain_text("arm: activate")
    expect(plan.get_by_role("list").nth(1)).to_contain_text("after drive_base")
    assert service.request("GET", SYSTEM)["target"]["state"] == "unconfigured"
    plan.get_by_role("button", name="Apply").click()
    expect(plan).to_be_hidden()
    expect(change(desktop)).to_contain_text("mode MANIPULATE, requested at")
    expect(change(desktop)).to_contain_text("succeeded after", timeout=SLOW_MS)


def test_a_plan_that_is_closed_changes_nothing(desktop: Page, service: Service) -> None:
    before = service.request("GET", "/changes")["items"][0]["id"]
    desktop.get_by_label("Plan first").check()
    desktop.locator("ph-lifecycle summary").click()
    desktop.get_by_role("button", name="activate", exact=True).click()
    plan = desktop.locator("ph-plan")
    expect(plan).to_contain_text("Plan: activate of mobile_manipulation, not requested yet")
    plan.get_by_role("button", name="Close").click()
    expect(plan).to_be_hidden()
    expect(desktop.get_by_label("Plan first")).to_be_focused()
    assert service.request("GET", "/changes")["items"][0]["id"] == before


def test_a_plan_of_one_part_is_not_shown_for_another(desktop: Page) -> None:
    desktop.get_by_label("Plan first").check()
    mode(desktop, "CAREFUL").get_by_role("radio").click()
    expect(desktop.locator("ph-plan")).to_be_visible()
    desktop.get_by_role("treeitem").filter(has_text="drive_base").last.click()
    expect(desktop.locator("ph-part-panel h2")).to_have_text("drive_base")
    expect(desktop.locator("ph-plan")).to_be_hidden()


def test_without_the_switch_a_mode_is_one_press_away(desktop: Page) -> None:
    mode(desktop, "CAREFUL").get_by_role("radio").click()
    expect(change(desktop)).to_contain_text("mode CAREFUL, requested at")
    expect(change(desktop)).to_contain_text("stage 3 of 3", timeout=SLOW_MS)
    expect(change(desktop).get_by_role("heading", name="Stage 3")).to_be_visible()


# --- the change ----------------------------------------------------------------------------------


def test_a_change_that_waits_says_for_what_and_can_be_canceled(
    desktop: Page, service: Service
) -> None:
    drain(service)
    expect(mode(desktop, "MANIPULATE").get_by_role("radio")).to_be_disabled()
    service.request("POST", f"{SYSTEM}/mode", {"mode": "MANIPULATE", "wait_for_s": 600})
    expect(change(desktop)).to_contain_text("waiting for ")
    expect(change(desktop)).to_contain_text("not met: battery_level >= 0.3")
    change(desktop).get_by_role("button", name="Stop waiting").click()
    expect(change(desktop)).to_contain_text("canceled after")
    expect(change(desktop).get_by_role("button", name="Stop waiting")).to_be_hidden()


def test_a_mode_is_entered_as_soon_as_it_may_if_that_was_asked(
    desktop: Page, service: Service
) -> None:
    drain(service)
    manipulate = mode(desktop, "MANIPULATE")
    manipulate.locator("summary").click()
    manipulate.get_by_role("button", name="Enter as soon as it may, within 10 min").click()
    expect(change(desktop)).to_contain_text("waiting for ")
    service.request("PATCH", "/mock/battery_level", {"value": 0.9})
    expect(change(desktop)).to_contain_text("succeeded after", timeout=SLOW_MS)


def test_waiting_for_what_it_cannot_help_is_rejected_with_the_reason(
    desktop: Page, service: Service
) -> None:
    service.request("PATCH", "/mock/temperature", {"value": 52})
    manipulate = mode(desktop, "MANIPULATE")
    manipulate.locator("summary").click()
    before = service.request("GET", "/changes")["items"][0]["id"]
    manipulate.get_by_role("button", name="Enter as soon as it may").click()
    expect(desktop.locator("ph-change")).to_contain_text("needs < 50")
    assert service.request("GET", "/changes")["items"][0]["id"] == before


def test_a_change_that_waited_begins_when_it_may(desktop: Page, service: Service) -> None:
    drain(service)
    expect(mode(desktop, "MANIPULATE").get_by_role("radio")).to_be_disabled()
    service.request("POST", f"{SYSTEM}/mode", {"mode": "MANIPULATE", "wait_for_s": 600})
    expect(change(desktop)).to_contain_text("waiting for ")
    service.request("PATCH", "/mock/battery_level", {"value": 0.9})
    expect(change(desktop)).to_contain_text("succeeded after", timeout=SLOW_MS)


def test_a_change_that_was_rolled_back_says_so_and_how(browser: Browser, failing: Service) -> None:
    failing.make_healthy()
    page = opened(browser, failing, 1280, 800)
    failing.request("POST", f"{SYSTEM}/state?wait=15", {"transition": "cleanup"})
    failing.request("POST", f"{SYSTEM}/mode", {"mode": "MANIPULATE"})
    expect(change(page).locator(".change-status")).to_contain_text("rolled back", timeout=SLOW_MS)
    expect(change(page).get_by_role("heading", name="Going back")).to_be_visible()
    expect(change(page).get_by_role("list").last).to_contain_text("drive_base: cleanup")
    page.close()


STEP: dict[str, Any] = {
    "node": "arm",
    "action": "activate",
    "status": "pending",
    "started_at": None,
    "ended_at": None,
    "error": None,
    "stage": 0,
    "after": [],
    "expected_s": None,
    "rollback": False,
}


def steps(*told: str) -> list[dict[str, Any]]:
    """Return steps of nodes from words such as "succeeded 0" or "running 1 back"."""
    every = []
    for words in told:
        status, stage, *back = words.split()
        every.append({**STEP, "status": status, "stage": int(stage), "rollback": bool(back)})
    return every


@pytest.mark.parametrize(
    ("made", "stage", "words"),
    [
        ([], 0, ""),
        (steps("running 0"), 0, "0 of 1 step"),
        (steps("succeeded 0", "running 0"), 0, "1 of 2 steps"),
        (
            steps("succeeded 0", "succeeded 0", "running 1", "pending 2"),
            1,
            "2 of 4 steps, stage 2 of 3",
        ),
        (
            steps("succeeded 0", "failed 1", "canceled 2", "succeeded 0 back"),
            1,
            "1 of 3 steps, stage 2 of 3",
        ),
    ],
)
def test_progress_counts_steps_and_stages_and_not_the_way_back(
    desktop: Page, made: list[dict[str, Any]], stage: int, words: str
) -> None:
    said = desktop.evaluate(
        """async (change) => {
            const { progressWords } = await import("/web/js/base/step_list.js");
            return progressWords(change);
        }""",
        {"steps": made, "stage": stage},
    )
    assert said == words


def test_a_change_on_its_way_back_and_its_deadline_are_in_words(desktop: Page) -> None:
    running = {
        "id": "c1",
        "part": "base",
        "request": {"mode": "FAST"},
        "status": "running",
        "reason": None,
        "started_at": "2026-05-04T12:00:00.000Z",
        "ended_at": None,
        "deadline_at": "2026-05-04T12:00:20.000Z",
        "rollback": None,
        "stage": 1,
        "steps": steps("succeeded 0", "failed 1", "running 0 back"),
    }
    said = desktop.evaluate(
        """(change) => {
            const shown = document.createElement("ph-change");
            document.body.append(shown);
            const knownAt = Date.parse("2026-05-04T12:00:08.000Z");
            shown.show({ part: { name: "base" }, change, problem: null, enabled: true, knownAt });
            return shown.textContent;
        }""",
        running,
    )
    assert "going back for 8.0 s" in said
    assert "1 of 2 steps, stage 2 of 2, times out in 12 s" in said


# --- why a part deviates -------------------------------------------------------------------------


def test_why_a_part_deviates_is_asked_only_while_it_is_open(
    browser: Browser, failing: Service
) -> None:
    failing.make_healthy()
    page = opened(browser, failing, 1280, 800)
    asked: list[str] = []

    def note(request: Request) -> None:
        if request.url.endswith("/why"):
            asked.append(request.url)

    page.on("request", note)
    failing.request("POST", f"{SYSTEM}/mode", {"mode": "CAREFUL"})
    expect(change(page)).to_contain_text("mode CAREFUL, requested at")
    expect(change(page)).to_contain_text("failed after", timeout=SLOW_MS)
    why = page.locator("ph-part-why")
    expect(why.locator("summary")).to_have_text("Why it deviates")
    assert asked == []
    why.locator("summary").focus()
    page.keyboard.press("Enter")
    expect(why.locator(".reason-tree")).to_contain_text(f"{LONG} is unconfigured, target active")
    expect(why.locator(".root")).to_have_text("root cause")
    assert asked
    failing.request("POST", f"{SYSTEM}/state", {"transition": "cleanup"})
    expect(why).to_be_hidden(timeout=SLOW_MS)
    page.close()


def test_a_fallback_says_why_until_the_requested_mode_is_back(
    desktop: Page, service: Service
) -> None:
    service.request("POST", f"{SYSTEM}/mode?wait=15", {"mode": "MANIPULATE"})
    service.request("PATCH", "/mock/temperature", {"value": 55})
    why = desktop.locator("ph-part-why")
    why.locator("summary").click()
    expect(why).to_contain_text("Target active.CAREFUL, set by a broken invariant")
    expect(why.locator(".reason-tree li li")).to_contain_text("Temperature is 55 °C, needs < 50 °C")
    service.request("PATCH", "/mock/temperature", {"value": 30})
    expect(why).to_be_hidden(timeout=SLOW_MS)
    expect(mode(desktop, "MANIPULATE").locator(".mark")).to_have_text("actual")


def test_a_part_that_is_displaced_says_by_whom_and_from_what(desktop: Page) -> None:
    said = desktop.evaluate(
        """() => {
            const shown = document.createElement("ph-part-why");
            document.body.append(shown);
            const target = { state: "active", mode: "FAST" };
            const fallback = { state: "active", mode: "SLOW", because: "invariant", rule: null };
            const part = { converged: true, target, effective_target: fallback };
            shown.show({ part, why: { blockers: [] }, signals: {} });
            return [shown.hidden, shown.textContent];
        }"""
    )
    assert said == [
        False,
        "Why this targetTarget active.SLOW, set by a broken invariant, in place of active.FAST "
        "that was requested.No reason is known.",
    ]


def test_the_mode_in_force_says_that_it_cannot_stay(desktop: Page) -> None:
    said = desktop.evaluate(
        """() => {
            const shown = document.createElement("ph-mode-switcher");
            document.body.append(shown);
            const actual = { state: "active", mode: "FAST" };
            const blockers = [{ message: "too hot", path: ["base"], refuses: true, causes: [] }];
            const item = { mode: "FAST", can_enter: false, can_stay: false, blockers };
            const part = { name: "base", kind: "node", actual, target: actual };
            shown.show({ part, modes: [item], enabled: true, isLive: true, signals: {} });
            return shown.querySelector(".mode").textContent;
        }"""
    )
    assert said == "FASTactual, cannot stayWhy not FASTtoo hot"
