"""What an operator needs when something is wrong: long presses, what was sent, what is known."""

import re
from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Locator, Page, Route, expect

from tests.browser.places import sentence
from tests.browser.robots import LONG, large_robot, troubled_robot
from tests.browser.station import Complaints, Service, serving

pytestmark = pytest.mark.browser

BROKEN_WORDS = """() => {
    const found = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        if (!node.parentElement.checkVisibility()) continue;
        if (node.parentElement.closest(".visually-hidden, script, option")) continue;
        for (const { 0: word, index } of node.data.matchAll(/[A-Za-z]{2,14}(?![\\w/.-])/g)) {
            if (/[\\w/.-]/.test(node.data[index - 1] ?? "")) continue;
            const range = document.createRange();
            range.setStart(node, index);
            range.setEnd(node, index + word.length);
            const lines = new Set([...range.getClientRects()].map(({ top }) => Math.round(top)));
            if (lines.size > 1) found.push(word);
        }
    }
    return found;
}"""


@pytest.fixture(scope="module")
def troubled(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    folder = tmp_path_factory.mktemp("troubled")
    with serving(folder, troubled_robot(folder)) as service:
        yield service


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    folder = tmp_path_factory.mktemp("large")
    with serving(folder, large_robot(folder)) as service:
        yield service


# Keeps the page busy from 0.9 s to 1.5 s after a press: it comes late to the end of a second.
BUSY = """() => addEventListener("pointerdown", () => setTimeout(() => {
    const end = performance.now() + 600;
    while (performance.now() < end);
}, 900), { once: true })"""


def opened(browser: Browser, service: Service, width: int, height: int) -> Page:
    page = browser.new_page(viewport={"width": width, "height": height})
    page.goto(service.url)
    expect(page.locator("ph-part-panel h2")).not_to_be_empty()
    return page


def card(page: Page, name: str) -> Locator:
    return page.locator("ph-signal-row").filter(has_text=name)


def press(button: Locator, page: Page, milliseconds: int) -> None:
    button.hover()
    page.mouse.down()
    page.wait_for_timeout(milliseconds)
    page.mouse.up()


def owners(service: Service) -> list[str]:
    return [hold["owner"] for hold in service.request("GET", "/holds")["items"]]


def test_a_tap_releases_no_hold_and_says_how_and_a_long_press_does(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    service.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    holds = desktop.get_by_role("list", name="Holds")
    release = holds.get_by_role("button")
    expect(release).to_have_accessible_name("Release gate (hold)")
    expect(release).to_have_text("Release")
    release.click()
    expect(release).to_have_text("Keep pressed")
    assert owners(service) == ["gate"]
    press(release, desktop, 1300)
    expect(holds).to_be_hidden()
    assert owners(service) == []
    assert complaints.messages == []


def test_a_long_press_counts_on_a_page_that_was_busy_when_its_second_was_over(
    desktop: Page, service: Service
) -> None:
    service.request("PUT", "/holds/gate", {})
    release = desktop.get_by_role("list", name="Holds").get_by_role("button")
    expect(release).to_have_text("Release")
    desktop.evaluate(BUSY)
    press(release, desktop, 1200)
    expect(release).to_have_count(0)
    assert owners(service) == []


def test_a_long_press_goes_on_while_other_holds_come_and_change_their_reasons(
    desktop: Page, service: Service
) -> None:
    service.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    release = desktop.get_by_role("button", name="Release gate (hold)")
    release.hover()
    desktop.mouse.down()
    for number in range(6):
        service.request("PUT", "/holds/other", {"reason": f"reason {number}"})
        desktop.wait_for_timeout(220)
    desktop.mouse.up()
    expect(release).to_have_count(0)
    assert owners(service) == ["other"]


def test_who_has_only_keys_holds_enter_and_who_can_only_click_confirms(
    desktop: Page, service: Service
) -> None:
    release = desktop.get_by_role("button", name="Release gate (hold)")
    service.request("PUT", "/holds/gate", {})
    release.focus()
    desktop.keyboard.press("Enter")
    desktop.wait_for_timeout(1200)
    assert owners(service) == ["gate"]
    desktop.keyboard.down("Enter")
    expect(release).to_have_count(0)
    desktop.keyboard.up("Enter")
    service.request("PUT", "/holds/gate", {})
    release.evaluate("(button) => button.click()")
    again = desktop.get_by_role("button", name="Release gate (hold): press again to confirm")
    expect(again).to_be_visible()
    assert owners(service) == ["gate"]
    again.evaluate("(button) => button.click()")
    expect(again).to_have_count(0)
    assert owners(service) == []


def test_an_error_that_wants_acknowledging_has_a_button_and_ends_by_it(
    browser: Browser, troubled: Service
) -> None:
    page = opened(browser, troubled, 1280, 800)
    notices = page.locator("ph-notices")
    button = notices.get_by_role("button", name="Acknowledge ESTOP (hold)")
    expect(button).to_have_count(0)
    troubled.request("POST", "/signals/estop", {"value": True})
    expect(button).to_be_visible()
    troubled.request("POST", "/signals/estop", {"value": False})
    expect(sentence(page)).to_contain_text("ESTOP, which waits for acknowledgement")
    button.click()
    expect(sentence(page)).to_contain_text("ERROR")
    page.wait_for_timeout(300)
    press(page.locator("ph-acknowledge button"), page, 1300)
    expect(sentence(page)).not_to_contain_text("ERROR")
    expect(page.locator("ph-acknowledge button")).to_have_count(0)
    page.close()


def test_a_dead_node_and_its_failed_change_are_in_the_sentence_and_its_modes_can_be_asked_for(
    browser: Browser, troubled: Service
) -> None:
    page = opened(browser, troubled, 1280, 800)
    troubled.request("POST", "/systems/actuation/mode", {"mode": "PERFORMANCE"})
    expect(sentence(page)).to_have_text(
        re.compile(r"^IDLE: manipulator is unreachable; no task$"), timeout=15_000
    )
    moderate = page.locator(".mode").filter(has_text="MODERATE")
    expect(moderate.locator(".blocker")).to_contain_text("⚠ ")
    expect(moderate.locator(".blocker")).to_contain_text("manipulator")
    expect(moderate.get_by_role("radio")).to_be_enabled()
    page.close()


def test_the_errors_of_the_selected_part_are_listed_with_their_times(
    browser: Browser, troubled: Service
) -> None:
    page = opened(browser, troubled, 1280, 800)
    page.get_by_role("treeitem", name=re.compile("^manipulator ")).click()
    errors = page.get_by_role("list", name="Errors of this part").get_by_role("listitem")
    expect(errors.first).to_have_text(
        re.compile(r"^⚠ UNREACHABLE for \d.* manipulator was never heard of$"), timeout=15_000
    )
    page.get_by_role("treeitem", name=re.compile("^drive_base ")).click()
    expect(page.locator("ph-error-list")).to_be_hidden()
    page.close()


def test_a_signal_that_nobody_sends_is_not_ok(browser: Browser, troubled: Service) -> None:
    page = opened(browser, troubled, 1280, 800)
    # Rows are brought up to date while they are in sight.
    card(page, "Load").scroll_into_view_if_needed()
    expect(card(page, "Load")).to_contain_text("no data")
    expect(card(page, "Load")).to_contain_text("never received")
    troubled.request("POST", "/signals/load", {"value": 1800.123456789})
    # Others that became worse meanwhile may have pushed it down.
    card(page, "Load").scroll_into_view_if_needed()
    expect(card(page, "Load")).to_contain_text("1800.1 kg")
    expect(card(page, "Load")).to_contain_text("OK")
    page.close()


def test_under_the_emergency_stop_the_card_and_the_stop_say_what_is(
    desktop: Page, service: Service
) -> None:
    desktop.get_by_role("button", name=re.compile("^STOP")).click()
    expect(card(desktop, "E-stop signal")).to_contain_text("stop engaged")
    expect(card(desktop, "E-stop signal")).to_contain_text("signal: not pressed")
    expect(card(desktop, "E-stop signal")).not_to_contain_text("released")
    expect(desktop.locator("ph-stop-button")).to_contain_text("the vehicle is at a standstill")


def test_a_blocker_that_changes_its_reason_and_not_its_code_is_asked_for_again(
    desktop: Page, service: Service
) -> None:
    service.request("POST", "/systems/actuation/state?wait=15", {"transition": "cleanup"})
    service.request("PATCH", "/mock/estop", {"value": True})
    blocker = desktop.locator(".mode").filter(has_text="MODERATE").locator(".blocker")
    expect(blocker).to_contain_text("e-stop is pressed")
    service.request("PUT", "/emergency_stop", {"engaged": True, "reason": "smoke"})
    service.request("PATCH", "/mock/estop", {"value": False})
    expect(blocker).to_contain_text("emergency stop is engaged")
    expect(blocker).not_to_contain_text("pressed")


@pytest.mark.parametrize(
    ("part", "name", "path"),
    [
        ("ph-mode-switcher", "PERFORMANCE", "**/mode"),
        ("ph-lifecycle", "configure", "**/state"),
        ("ph-task-sheet", "Drive the example loop", "**/tasks?*"),
        ("ph-hold-chips", "Release gate (hold)", "**/holds/gate"),
    ],
)
def test_a_press_shows_that_it_was_sent_before_the_answer_is_there(
    desktop: Page, service: Service, part: str, name: str, path: str
) -> None:
    service.request("POST", "/systems/actuation/state?wait=15", {"transition": "cleanup"})
    service.request("PUT", "/holds/gate", {})
    waiting: list[Route] = []
    desktop.route(
        path,
        lambda route: route.continue_() if route.request.method == "GET" else waiting.append(route),
    )
    if part == "ph-lifecycle":
        desktop.locator("ph-part-panel summary").filter(has_text="Lifecycle").click()
    if part == "ph-task-sheet":
        desktop.get_by_role("button", name="New task").click()
    role: Any = "radio" if part == "ph-mode-switcher" else "button"
    button = desktop.locator(part).get_by_role(role, name=name)
    expect(button).to_be_enabled()
    if "(hold)" in name:
        press(button, desktop, 1300)
    else:
        button.click()
    sent = desktop.locator(part).locator("[data-sending] .sent")
    expect(sent).to_have_text("sent …")
    for _ in range(100):
        if waiting:
            break
        # The example is loaded before it is sent.
        desktop.wait_for_timeout(20)
    [route] = waiting
    expect(sent).to_have_text("sent …")
    route.fulfill(status=409, json={"title": "Refused", "detail": "not now", "status": 409})
    expect(sent).to_have_count(0)
    told = part if part in ("ph-task-sheet", "ph-hold-chips") else "ph-change"
    expect(desktop.locator(told)).to_contain_text(re.compile("(Rejected|Not released): not now"))
    desktop.unroute_all(behavior="wait")


def test_without_an_answer_nothing_is_called_rejected(desktop: Page, service: Service) -> None:
    service.request("POST", "/systems/actuation/state?wait=15", {"transition": "cleanup"})
    desktop.route("**/mode", lambda route: route.abort())
    mode = desktop.get_by_role("radio", name="MODERATE")
    expect(mode).to_be_enabled()
    mode.click()
    alert = desktop.locator("ph-change").get_by_role("alert")
    expect(alert).to_contain_text("No answer: ")
    expect(alert).not_to_contain_text("Rejected")


@pytest.mark.parametrize(("width", "height"), [(360, 640), (800, 700), (1280, 800)])
def test_no_word_breaks_into_letters_beside_a_long_name(
    browser: Browser, large: Service, width: int, height: int
) -> None:
    large.request("PUT", f"/holds/{LONG[:60]}", {"reason": f"{LONG} is being looked at"})
    page = opened(browser, large, width, height)
    expect(page.get_by_role("list", name="Holds")).to_contain_text(LONG)
    if width < 1024:
        page.get_by_role("tab", name="Parts").click()
    page.get_by_role("treeitem", name=re.compile(f"^{LONG} node")).click()
    expect(page.get_by_role("radio", name="FAST")).to_be_visible()
    assert page.evaluate(BROKEN_WORDS) == []
    assert page.evaluate("document.documentElement.scrollWidth") == width
    page.close()


def test_on_a_phone_a_tap_far_down_the_list_shows_the_part_and_one_comes_back(
    browser: Browser, large: Service
) -> None:
    page = opened(browser, large, 360, 640)
    page.get_by_role("tab", name="Parts").click()
    row = page.get_by_role("treeitem", name=re.compile("^node_090 "))
    # Only rows near what is seen are drawn.
    page.get_by_role("treeitem").last.hover()
    for _ in range(40):
        if row.count() > 0:
            break
        page.mouse.wheel(0, 400)
        page.wait_for_timeout(50)
    row.click()
    heading = page.locator("ph-part-panel h2")
    expect(heading).to_have_text("node_090")
    expect(heading).to_be_in_viewport()
    expect(heading).to_be_focused()
    expect(page.get_by_role("radio", name="FAST")).to_be_in_viewport()
    page.get_by_role("button", name="Back", exact=True).click()
    expect(row).to_be_in_viewport()
    expect(row).to_be_focused()
    page.close()


def test_with_the_colours_of_the_system_stop_keeps_shape_and_colour(
    browser: Browser, service: Service
) -> None:
    page = browser.new_page(forced_colors="active")
    page.goto(service.url)
    octagon = page.locator(".octagon")
    expect(octagon).to_have_text("STOP")
    look = octagon.evaluate(
        """(node) => {
            const { backgroundColor } = getComputedStyle(node, "::before");
            const { color, clipPath } = getComputedStyle(node);
            return [backgroundColor, color, clipPath.startsWith("polygon")];
        }"""
    )
    assert look in (
        ["rgb(196, 16, 30)", "rgb(255, 255, 255)", True],
        ["rgb(209, 26, 40)", "rgb(255, 255, 255)", True],
    )
    page.close()


def test_messages_have_no_words_of_the_interface(desktop: Page, service: Service) -> None:
    desktop.get_by_role("button", name="New task").click()
    form = desktop.locator("ph-task-form")
    form.get_by_label("Speed, m/s").fill("99")
    form.get_by_label("Speed, m/s").blur()
    scans: Any = {
        "name": "field.csv",
        "mimeType": "text/csv",
        "buffer": service.track_ahead(30, scans=True),
    }
    desktop.get_by_label("Choose a CSV").set_input_files(scans)
    expect(form).to_contain_text("The speed must be a number from 0.1 to 11.2 m/s.")
    form.get_by_label("Speed, m/s").fill("2.8")
    form.get_by_label("Speed, m/s").blur()
    expect(form).to_contain_text(
        "say above what the columns are, such as x,y, or what its headings are in", timeout=10_000
    )
    assert not re.search(r"/speed_mps|\?heading|\?columns|start_index", form.inner_text())


@pytest.mark.parametrize(
    ("problem", "said", "hint"),
    [
        (
            {"detail": "/speed_mps: speed 99 m/s is not within 0.1 to 11.2 m/s"},
            "speed 99 m/s is not within 0.1 to 11.2 m/s",
            "",
        ),
        ({"detail": "query speed_mps: not a number"}, "Speed: not a number", ""),
        ({"detail": "x", "hint": "set ?columns=x,y,yaw"}, "x", "say above what the columns are"),
        ({"detail": "x", "hint": "there is none now; see GET /tasks"}, "x", ""),
        (
            {"detail": "x", "hint": "waypoint 1 is 0.0 m away: start there with start_index"},
            "x",
            "",
        ),
        ({"detail": "x", "hint": "start the service with --mock-signals"}, "x", ""),
        ({"detail": "x", "hint": "restart the node"}, "x", "restart the node"),
    ],
)
def test_a_problem_is_told_in_words_of_the_page(
    desktop: Page, problem: dict[str, str], said: str, hint: str
) -> None:
    told = desktop.evaluate(
        """async (problem) => {
            const words = await import("/web/js/base/problem.js");
            return [words.detailWords(problem), words.hintWords(problem)];
        }""",
        problem,
    )
    assert told[0] == said
    assert told[1].startswith(hint)
    assert hint or not told[1]


def test_without_contact_no_card_is_ok_and_nothing_is_called_reachable(
    desktop: Page, service: Service
) -> None:
    expect(card(desktop, "Battery")).to_contain_text("OK")
    service.kill()
    expect(sentence(desktop)).to_contain_text("No contact for ", timeout=10_000)
    rows = desktop.locator("ph-signal-row")
    assert set(rows.locator(".signal-word").all_inner_texts()) == {"no contact"}
    ages = rows.locator(".age").all_inner_texts()
    assert [age.endswith(" old") for age in ages] == [True] * 5
    known = desktop.locator(".dot").evaluate_all("(dots) => dots.map((dot) => dot.dataset.look)")
    assert set(known) == {"unknown"}
    expect(sentence(desktop)).to_have_attribute("title", re.compile("it was IDLE: no task"))
    service.start()
