"""What a person does with the list of parts: find one of many, and see which of them needs help."""

import re
import time
from collections.abc import Iterator

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Locator, Page, expect

from tests.browser.robots import crowded_robot
from tests.browser.station import Complaints, Service, serving

pytestmark = pytest.mark.browser

SLOW_MS = 20_000
"""For a change of 300 nodes, and a page of 1,000 parts, while other tests run."""
SLOWED = "perception/unit_03/camera_wheel_003"


def set_rate(service: Service, rate: int) -> None:
    """Change the mode of one node behind the back of whoever activated it."""
    service.request("PATCH", f"/nodes/{SLOWED}/parameters", {"rate": rate})


@pytest.fixture(scope="module")
def crowded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """300 nodes that were activated; two are dead, one failed, and one was made slow."""
    folder = tmp_path_factory.mktemp("crowded")
    with serving(folder, crowded_robot(folder, 300, faulty=True)) as service:
        change = service.request("POST", "/systems/carrier/mode", {"mode": "__DEFAULT__"})["id"]
        while service.request("GET", f"/changes/{change}")["status"] == "running":
            time.sleep(0.2)
        set_rate(service, 2)
        yield service


@pytest.fixture(scope="module")
def huge(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    folder = tmp_path_factory.mktemp("huge")
    with serving(folder, crowded_robot(folder, 1000)) as service:
        yield service


def opened(browser: Browser, service: Service, width: int = 1440, height: int = 900) -> Page:
    page = browser.new_page(viewport={"width": width, "height": height})
    page.goto(service.url)
    expect(page.locator("ph-part-panel h2")).not_to_be_empty(timeout=SLOW_MS)
    if width < 1024:
        page.get_by_role("tab", name="Parts").click()
    return page


@pytest.fixture
def page(browser: Browser, crowded: Service, complaints: Complaints) -> Iterator[Page]:
    page = opened(browser, crowded)
    complaints.watch(page)
    yield page
    page.close()
    assert complaints.messages == []


def row(page: Page, name: str) -> Locator:
    return page.get_by_role("treeitem", name=re.compile(f"^{name} ".replace("/", r"\/")))


def urgent(page: Page) -> Locator:
    return page.get_by_role("listbox", name="Needs attention").get_by_role("option")


def field(page: Page) -> Locator:
    return page.get_by_role("searchbox", name="Filter parts by name")


def said(page: Page) -> Locator:
    return page.locator("ph-part-tree").get_by_role("status")


# --- a few parts ---------------------------------------------------------------------------------


def test_a_row_tells_state_and_mode_and_what_of_it_is_inferred(
    desktop: Page, service: Service
) -> None:
    service.request("POST", "/systems/actuation/mode?wait=15", {"mode": "PERFORMANCE"})
    base = row(desktop, "drive_base")
    expect(base).to_contain_text("active.FAST (*)")
    expect(base.locator(".inferred")).to_have_text("FAST")
    expect(base).to_have_attribute("aria-label", "drive_base node, active.FAST inferred")
    # Since when it is in this state is known from the events.
    expect(base.locator(".age")).to_have_text(re.compile(r"^\d+ s$"))
    expect(row(desktop, "actuation")).to_contain_text("active.PERFORMANCE (*)")
    expect(desktop.locator("ph-part-tree .summary").last).to_have_text(
        "3 parts, none needs attention"
    )
    service.request("POST", "/systems/actuation/mode?wait=15", {"mode": "__DEFAULT__"})
    expect(base).to_contain_text("active.default (*)")
    expect(desktop.locator("ph-part-tree")).not_to_contain_text("__DEFAULT__")


def test_rows_are_dense_for_a_mouse_and_large_for_a_thumb(
    browser: Browser, service: Service
) -> None:
    for width, height_px in ((1440, 28), (360, 44)):
        page = opened(browser, service, width, 900)
        expect(row(page, "drive_base")).to_be_visible()
        box = row(page, "drive_base").bounding_box()
        assert box is not None
        assert box["height"] == height_px
        page.close()


# --- what needs attention ------------------------------------------------------------------------


def test_what_needs_attention_stands_above_all_with_its_cause(page: Page) -> None:
    expect(urgent(page)).to_have_count(4, timeout=SLOW_MS)
    dead = urgent(page).filter(has_text="brake_002")
    expect(dead).to_contain_text("unreachable")
    expect(dead.locator(".cause")).to_have_text("was never heard of")
    expect(dead.locator(".name")).to_have_attribute("title", "motion/unit_04/brake_002")
    slow = urgent(page).filter(has_text="camera_wheel_003")
    expect(slow).to_contain_text("SLOW")
    expect(slow.locator(".age")).not_to_be_empty()
    # The red ones come first.
    expect(urgent(page).nth(0)).to_have_attribute("data-look", "unreachable")
    expect(urgent(page).nth(3)).to_have_attribute("data-look", "deviating")


def test_systems_that_deviate_because_of_a_node_name_it_and_come_after_it(page: Page) -> None:
    page.get_by_role("button", name="8 systems follow from these").click()
    expect(page.get_by_role("radio", name="Attention")).to_be_checked()
    expect(said(page)).to_have_text("12 of 334 shown")
    unit = urgent(page).filter(has_text="perception_unit_03")
    expect(unit.locator(".cause")).to_have_text("because camera_wheel_003 is SLOW")
    motion = urgent(page).filter(has_text=re.compile("^motion_unit_04"))
    expect(motion.locator(".cause")).to_have_text("because brake_002 is unreachable")
    expect(page.get_by_role("tree")).to_be_hidden()


def test_why_counts_no_parts_beside_the_errors_that_name_them(page: Page) -> None:
    expect(page.locator("header .more")).to_contain_text("+3")
    expect(page.locator("ph-why")).to_contain_text("UNREACHABLE")
    expect(page.locator("ph-why")).not_to_contain_text("more such")


def test_attention_is_narrowed_to_what_deviates_or_is_faulty(page: Page) -> None:
    page.get_by_role("radio", name="Attention").check(force=True)
    page.get_by_role("radio", name="Faulty").check(force=True)
    expect(said(page)).to_have_text("2 of 334 shown")
    expect(urgent(page)).to_have_count(2)
    page.get_by_role("radio", name="Deviating").check(force=True)
    expect(said(page)).to_have_text("10 of 334 shown")
    field(page).fill("fan")
    expect(said(page)).to_have_text("1 of 334 shown")
    page.get_by_role("radio", name="Faulty").check(force=True)
    expect(said(page)).to_have_text("No part matches “fan”.")
    field(page).press("Escape")
    page.get_by_role("radio", name="All").check(force=True)
    expect(page.get_by_role("tree")).to_be_visible()


def test_the_chip_of_the_header_leads_to_the_parts_that_it_counts(page: Page) -> None:
    page.get_by_role("button", name="2 unreachable").click()
    expect(urgent(page).first).to_be_focused()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    expect(page.locator("ph-part-panel h2")).to_contain_text("imu_004")


def test_nothing_needs_attention_is_said_in_words(desktop: Page, service: Service) -> None:
    service.request("POST", "/systems/actuation/mode?wait=15", {"mode": "MODERATE"})
    desktop.get_by_role("radio", name="Attention").check(force=True)
    expect(said(desktop)).to_have_text("No part needs attention.")
    desktop.get_by_role("radio", name="Faulty").check(force=True)
    expect(said(desktop)).to_have_text("No part is faulty.")


# --- many parts ----------------------------------------------------------------------------------


def test_the_systems_of_a_large_robot_are_closed_and_tell_the_worst_below_them(
    page: Page,
) -> None:
    expect(row(page, "carrier")).to_have_attribute("aria-expanded", "true")
    expect(row(page, "motion")).to_have_attribute("aria-expanded", "false")
    expect(page.get_by_role("treeitem")).to_have_count(4)
    badge = row(page, "motion").locator(".below")
    expect(badge).to_have_text("2")
    expect(badge).to_have_attribute("data-look", "unreachable")
    expect(row(page, "motion")).to_have_accessible_name(re.compile("2 below: unreachable"))
    row(page, "motion").locator(".twist").click()
    expect(row(page, "motion_unit_04")).to_contain_text("1")
    expect(badge).to_be_hidden()
    expect(row(page, "motion_unit_01")).to_have_attribute("aria-setsize", "11")


def test_a_namespace_is_told_once_and_the_whole_name_is_in_reach(page: Page) -> None:
    row(page, "perception").locator(".twist").click()
    row(page, "perception_unit_00").locator(".twist").click()
    expect(page.locator(".space").first).to_have_text("perception/unit_00/")
    camera = row(page, "perception/unit_00/camera_000")
    expect(camera.locator(".name")).to_have_text("camera_000")
    expect(camera.locator(".name")).to_have_attribute("title", "perception/unit_00/camera_000")


def test_a_part_of_two_systems_has_a_row_in_each(page: Page) -> None:
    field(page).fill("shared_clock")
    expect(row(page, "motion/shared_clock")).to_have_count(2)
    row(page, "motion/shared_clock").first.click()
    expect(row(page, "motion/shared_clock").nth(1)).to_have_attribute("aria-selected", "true")


def test_the_filter_says_how_many_it_shows_and_opens_the_way_to_them(page: Page) -> None:
    field(page).fill("unit_03 LIDAR")
    expect(said(page)).to_have_text("2 of 334 shown")
    expect(row(page, "perception/unit_03/lidar_001")).to_be_visible()
    expect(urgent(page)).to_have_count(0)
    field(page).press("ArrowDown")
    expect(row(page, "carrier")).to_be_focused()
    field(page).fill("nothing of the kind")
    expect(said(page)).to_have_text("No part matches “nothing of the kind”.")
    expect(page.get_by_role("treeitem")).to_have_count(0)
    field(page).press("Escape")
    expect(field(page)).to_have_value("")
    expect(said(page)).to_be_empty()
    expect(page.get_by_role("treeitem")).to_have_count(4)


def test_a_name_is_found_by_its_first_letters_and_both_ends_by_a_key(page: Page) -> None:
    row(page, "carrier").focus()
    page.keyboard.press("End")
    expect(row(page, "power")).to_be_focused()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Home")
    expect(row(page, "carrier")).to_be_focused()
    page.keyboard.type("power_unit_1")
    expect(row(page, "power_unit_11")).to_be_focused()
    page.keyboard.press("ArrowLeft")
    expect(row(page, "power")).to_be_focused()
    page.keyboard.press("ArrowLeft")
    expect(row(page, "power")).to_have_attribute("aria-expanded", "false")


def test_the_row_in_focus_keeps_it_however_far_one_scrolls_and_whatever_changes(
    page: Page, crowded: Service
) -> None:
    # Opens all that leads to what matches, which is every node but one.
    field(page).fill("unit")
    focused = page.get_by_role("treeitem").nth(5)
    name = focused.get_attribute("aria-label")
    assert name is not None
    focused.focus()
    page.get_by_role("tree").evaluate("(tree) => (tree.parentNode.scrollTop = 1e6)")
    page.wait_for_timeout(300)
    set_rate(crowded, 10)
    expect(page.get_by_role("radio", name="Attention 3")).to_be_visible()
    set_rate(crowded, 2)
    expect(page.get_by_role("radio", name="Attention 4")).to_be_visible()
    expect(page.get_by_role("treeitem", name=name.split()[0])).to_be_focused()
    page.keyboard.press("ArrowDown")
    expect(page.locator("[role=treeitem]:focus")).to_be_in_viewport()


# --- squares -------------------------------------------------------------------------------------


def test_each_node_is_a_square_that_tells_its_name_and_is_selected_by_a_click(page: Page) -> None:
    squares = page.locator("ph-part-squares")
    expect(squares.locator("p")).to_have_text("300 nodes: 2 unreachable, 2 deviating")
    # Shapes tell them apart as well: a cross and a triangle for each.
    assert squares.locator("path.unreachable").get_attribute("d").count("M") == 2  # type: ignore[union-attr]
    assert squares.locator("path.deviating").get_attribute("d").count("M") == 2  # type: ignore[union-attr]
    box = squares.locator("svg").bounding_box()
    assert box is not None
    cell = box["width"] / 26.2
    page.mouse.move(box["x"] + 2.6 * cell, box["y"] + 0.6 * cell)
    expect(squares.locator("p")).to_have_text("perception/unit_00/radar_002: active.default")
    page.mouse.down()
    page.mouse.up()
    expect(page.locator("ph-part-panel h2")).to_contain_text("radar_002")


def test_squares_are_walked_by_the_arrows_and_read_as_options(page: Page) -> None:
    box = page.get_by_role("listbox", name="Nodes as squares")
    box.focus()
    page.keyboard.press("End")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowRight")
    option = box.get_by_role("option")
    expect(option).to_have_attribute("aria-setsize", "300")
    expect(option).to_have_attribute("aria-posinset", "275")
    expect(option).to_have_text(re.compile(r"^power/unit_\d\d/\w+: active"))
    words = option.text_content()
    assert words is not None
    page.keyboard.press("Enter")
    expect(option).to_have_attribute("aria-selected", "true")
    expect(page.locator("ph-part-panel h2")).to_contain_text(words.split(":")[0].split("/")[-1])


def test_a_few_nodes_need_no_squares(desktop: Page) -> None:
    expect(row(desktop, "drive_base")).to_be_visible()
    expect(desktop.locator("ph-part-squares")).to_have_count(0)


# --- 1,000 parts ---------------------------------------------------------------------------------

TOUCHED = """(tree) => new Promise((resolve) => {
    let touched = 0;
    // Ages of less than a minute count on.
    const isAge = (node) => (node.nodeType === 3 ? node.parentElement : node).matches(".age");
    const observer = new MutationObserver((records) => {
        touched += records.filter(({ target }) => !isAge(target)).length;
    });
    observer.observe(tree, { attributes: true, childList: true, subtree: true });
    setTimeout(() => resolve(touched), 2000);
})"""


def test_of_a_thousand_parts_only_the_rows_that_can_be_seen_are_drawn(
    browser: Browser, huge: Service
) -> None:
    page = opened(browser, huge)
    field(page).fill("unit")
    for _ in range(60):
        page.keyboard.press("ArrowDown")
        page.keyboard.press("ArrowRight")
    drawn = page.get_by_role("treeitem").count()
    total = page.evaluate("parseFloat(document.querySelector('[role=tree]').style.height) / 28")
    assert total > 100
    assert drawn < 60
    page.get_by_role("tree").evaluate("(tree) => (tree.parentNode.scrollTop = 1e6)")
    expect(row(page, "power/unit_\\d\\d/fuse_\\d\\d\\d").last).to_be_in_viewport()
    assert page.get_by_role("treeitem").count() < 60
    page.close()


def test_parts_at_rest_touch_nothing_of_the_document(browser: Browser, huge: Service) -> None:
    page = opened(browser, huge)
    expect(page.locator("ph-part-squares p")).to_have_text("1000 nodes: all normal")
    page.wait_for_timeout(500)
    touched = page.locator("ph-part-tree").evaluate(TOUCHED)
    assert touched == 0
    page.close()


# --- a phone -------------------------------------------------------------------------------------


def test_on_a_phone_one_scrolls_the_whole_list_and_finds_what_one_selects(
    browser: Browser, crowded: Service
) -> None:
    page = opened(browser, crowded, 360, 640)
    row(page, "motion").locator(".twist").click()
    row(page, "motion_unit_07").locator(".twist").click()
    motor = row(page, "motion/unit_07/motor_005")
    motor.scroll_into_view_if_needed()
    expect(motor).to_be_in_viewport()
    motor.click()
    expect(page.locator("ph-part-panel h2")).to_contain_text("motor_005")
    assert page.evaluate("document.documentElement.scrollWidth") == 360
    page.close()
