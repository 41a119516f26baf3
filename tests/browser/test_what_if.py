"""What would happen if: a copy of the robot in simulated time; and the switches of the mock."""

import re
import time
from collections.abc import Callable

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Locator, Page, expect

from tests.browser.places import sentence
from tests.browser.station import Complaints, Service

pytestmark = pytest.mark.browser

SIMULATED_MS = 30_000
"""The first simulation starts a process of its own."""


def drawer(page: Page) -> Locator:
    return page.get_by_role("dialog", name="What if")


def outcome(page: Page, topic: str) -> Locator:
    """Return the row of a topic: live, and simulated."""
    table = drawer(page).get_by_role("table", name="The robot now, and in the simulation")
    return table.get_by_role("row").filter(
        has=page.get_by_role("rowheader", name=topic, exact=True)
    )


def opened(page: Page) -> Locator:
    page.evaluate("document.dispatchEvent(new CustomEvent('ph-what-if', { detail: {} }))")
    expect(outcome(page, "State")).to_be_visible(timeout=SIMULATED_MS)
    return drawer(page)


def mock_of(page: Page, name: str) -> Locator:
    """Return the switches of a mock signal, which the drawer keeps folded."""
    opened(page)
    drawer(page).get_by_text("Mock signals of this robot").click()
    return drawer(page).get_by_role("group", name=name)


def slide(page: Page, slider: Locator, share: float) -> None:
    slider.scroll_into_view_if_needed()
    box = slider.bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + box["width"] * share, box["y"] + box["height"] / 2)


def writes(service: Service) -> list[str]:
    items = service.request("GET", "/events?kind=audit.*&limit=1000")["items"]
    return [f"{item['kind']} {item['data'].get('path')}" for item in items]


@pytest.fixture
def unwritten(service: Service) -> Callable[[], list[str]]:
    """Tell which requests have changed the live robot since the test began."""
    before = len(writes(service))
    return lambda: writes(service)[before:]


def test_a_low_battery_is_tried_on_a_copy_and_the_live_robot_is_not_touched(
    desktop: Page, unwritten: Callable[[], list[str]], complaints: Complaints
) -> None:
    desktop.get_by_role("button", name="What if").first.click()
    expect(outcome(desktop, "State")).to_contain_text("IDLE: no task", timeout=SIMULATED_MS)
    expect(drawer(desktop)).to_contain_text("SIMULATION")
    slide(desktop, drawer(desktop).get_by_role("slider", name="Simulated Battery: set"), 0.2)
    state = outcome(desktop, "State")
    simulated = state.get_by_role("cell").last
    expect(simulated).to_contain_text("is below 50 %", timeout=SIMULATED_MS)
    expect(state.get_by_role("cell").first).to_have_text("IDLE: no task")
    expect(outcome(desktop, "Errors").get_by_role("cell").last).to_contain_text("BATTERY_LOW")
    expect(sentence(desktop)).to_have_text("IDLE: no task")
    drawer(desktop).get_by_role("button", name="Leave Battery as it is").click()
    expect(simulated).to_have_text("IDLE: no task", timeout=SIMULATED_MS)
    assert unwritten() == []
    assert complaints.messages == []


def test_a_node_that_dies_and_a_mode_show_which_parts_differ_and_when(
    desktop: Page, unwritten: Callable[[], list[str]], complaints: Complaints
) -> None:
    form = opened(desktop)
    form.get_by_role("combobox", name="What happens").select_option("A mode is requested")
    form.get_by_role("combobox", name="To what").select_option("actuation")
    form.get_by_role("combobox", name="How", exact=True).select_option("PERFORMANCE")
    form.get_by_role("button", name="Add", exact=True).click()
    form.get_by_role("combobox", name="What happens").select_option("A node fails")
    form.get_by_role("combobox", name="To what").select_option("manipulator")
    form.get_by_role("combobox", name="How", exact=True).select_option("dies")
    form.get_by_role("spinbutton", name="After how many seconds").fill("20")
    form.get_by_role("button", name="Add", exact=True).click()
    arm = outcome(desktop, "manipulator").get_by_role("cell")
    expect(arm.last).to_contain_text("unknown", timeout=SIMULATED_MS)
    # Before the failure it was in the mode that was requested.
    head = form.get_by_role("slider", name="Moment of the simulation")
    slide(desktop, head, 0.5)
    expect(arm.last).to_contain_text("active.STRONG")
    form.get_by_role("button", name=re.compile(r"^2\d\.\d s$")).first.click()
    expect(arm.last).to_contain_text("unknown")
    form.get_by_role("button", name="Take away: after 20 s: manipulator dies").click()
    expect(form.get_by_role("list", name="Steps of the simulation")).not_to_contain_text("dies")
    assert unwritten() == []
    assert complaints.messages == []


def test_a_step_that_the_robot_refuses_says_why(
    desktop: Page, unwritten: Callable[[], list[str]], complaints: Complaints
) -> None:
    form = opened(desktop)
    form.get_by_role("combobox", name="What happens").select_option("STOP is pressed")
    form.get_by_role("button", name="Add", exact=True).click()
    stop = outcome(desktop, "Emergency stop")
    expect(stop).to_contain_text("not engaged≠ engaged", timeout=SIMULATED_MS)
    form.get_by_role("combobox", name="What happens").select_option("A mode is requested")
    form.get_by_role("combobox", name="To what").select_option("actuation")
    form.get_by_role("combobox", name="How", exact=True).select_option("MODERATE")
    form.get_by_role("spinbutton", name="After how many seconds").fill("3")
    form.get_by_role("button", name="Add", exact=True).click()
    steps = form.get_by_role("list", name="Steps of the simulation")
    expect(steps).to_contain_text("actuation: mode MODERATE requested")
    expect(steps).to_contain_text("Refused: ", timeout=SIMULATED_MS)
    expect(steps.get_by_role("listitem").first).not_to_contain_text("Refused")
    assert unwritten() == []
    assert complaints.messages == []


def test_a_robot_that_is_real_cannot_be_copied_and_the_drawer_says_so(desktop: Page) -> None:
    fault = {"pointer": "/from", "code": "INVALID_VALUE", "message": "the live robot is real"}
    refusal = {"title": "x", "detail": "/from: the live robot is real", "errors": [fault]}
    desktop.route("**/simulations", lambda route: route.fulfill(status=422, json=refusal))
    desktop.get_by_role("button", name="What if").first.click()
    alert = drawer(desktop).get_by_role("alert")
    expect(alert).to_have_text("This robot is real, and only a simulated one can be copied.")
    expect(drawer(desktop).get_by_role("slider")).to_have_count(0)


def test_the_drawer_leaves_stop_within_reach_and_escape_closes_it(
    desktop: Page, complaints: Complaints
) -> None:
    button = desktop.get_by_role("button", name="What if").first
    button.click()
    expect(drawer(desktop)).to_be_visible()
    stop = desktop.get_by_role("button", name=re.compile("^STOP"))
    stop.click(trial=True)
    desktop.keyboard.press("Escape")
    expect(drawer(desktop)).to_be_hidden()
    expect(button).to_be_focused()
    assert complaints.messages == []


def test_on_a_phone_the_drawer_takes_the_page_and_never_scrolls_sideways(
    phone: Page, complaints: Complaints
) -> None:
    opened(phone)
    expect(phone.locator("ph-map")).to_be_hidden()
    assert phone.evaluate("document.documentElement.scrollWidth") == 360
    phone.get_by_role("button", name=re.compile("^STOP")).click(trial=True)
    drawer(phone).get_by_role("button", name="Close").click()
    expect(drawer(phone)).to_be_hidden()
    assert complaints.messages == []


def test_a_battery_dragged_low_is_an_error_that_says_why_and_ends_when_it_is_full(
    desktop: Page, complaints: Complaints
) -> None:
    slider = mock_of(desktop, "Battery").get_by_role("slider")
    slider.scroll_into_view_if_needed()
    box = slider.bounding_box()
    assert box is not None
    middle = box["y"] + box["height"] / 2
    desktop.mouse.move(box["x"] + box["width"] * 0.9, middle)
    desktop.mouse.down()
    desktop.mouse.move(box["x"] + box["width"] * 0.3, middle, steps=15)
    expect(sentence(desktop)).to_have_text(re.compile(r"^ERROR: battery \d+ % is below 50 %$"))
    expect(desktop.locator("ph-signal-row").first).to_contain_text("BATTERY_LOW")
    desktop.mouse.move(box["x"] + box["width"] * 0.95, middle, steps=15)
    desktop.mouse.up()
    expect(sentence(desktop)).to_have_text("IDLE: no task")
    assert complaints.messages == []


def test_a_slider_that_is_dragged_asks_at_most_ten_times_a_second(desktop: Page) -> None:
    slider = mock_of(desktop, "Temperature").get_by_role("slider")
    slider.scroll_into_view_if_needed()
    box = slider.bounding_box()
    assert box is not None
    middle = box["y"] + box["height"] / 2
    asked: list[str] = []
    desktop.on("request", lambda request: asked.append(request.method))
    desktop.mouse.move(box["x"] + box["width"] * 0.3, middle)
    desktop.mouse.down()
    begin = time.monotonic()
    for step in range(40):
        desktop.mouse.move(box["x"] + box["width"] * (0.1 + step / 100), middle)
        desktop.wait_for_timeout(25)
    seconds = time.monotonic() - begin
    desktop.mouse.up()
    assert 5 <= asked.count("PATCH") <= 10 * seconds + 1


def test_a_mock_signal_that_is_switched_off_grows_old_and_is_called_stale(
    desktop: Page, complaints: Complaints
) -> None:
    mock_of(desktop, "Temperature").get_by_role("switch", name="Temperature: publishing").click()
    temperature = desktop.locator("ph-signal-row").filter(has_text="Temperature")
    expect(temperature).to_contain_text("stale")
    expect(temperature).to_contain_text(re.compile(r"[2-9]\.\d s old"))
    expect(sentence(desktop)).to_contain_text("ERROR")
    assert complaints.messages == []
