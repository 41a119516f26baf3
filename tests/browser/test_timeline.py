"""The timeline: what happened, told and shown again, by the hands of an operator."""

import json
import re
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Locator, Page, expect

from tests.browser.robots import large_robot
from tests.browser.station import Complaints, Service, serving

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.browser

REPLAYED_MS = 60_000
"""A process replays up to the moment; on a busy computer that takes a while."""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service that records what happens in a folder."""
    folder = tmp_path_factory.mktemp("recorded")
    with serving(folder, keeps=True) as service:
        yield service


@pytest.fixture
def robot(recorded: Service) -> Service:
    recorded.make_healthy()
    return recorded


@pytest.fixture
def page(browser: "Browser", robot: Service, complaints: Complaints) -> Iterator[Page]:
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    page = context.new_page()
    complaints.watch(page)
    page.goto(robot.url)
    yield page
    context.close()


def timeline(page: Page) -> Locator:
    return page.get_by_role("slider", name="Timeline")


def tip(page: Page) -> Locator:
    return page.locator("ph-timeline .tip")


def note(page: Page) -> Locator:
    return page.locator(".timeline-note")


def band(page: Page) -> Locator:
    return page.locator("ph-moment-bar")


def lane_y(page: Page, name: str) -> float:
    """Return where a lane is, px below the top of the canvas."""
    row = page.locator(".lane-names li").filter(has_text=re.compile(f"^{name}$")).bounding_box()
    canvas = timeline(page).bounding_box()
    assert row is not None
    assert canvas is not None
    return row["y"] + row["height"] / 2 - canvas["y"]


def ground(page: Page) -> list[int]:
    """Return the colour of what nothing is drawn on: the lower left of the axis."""
    pixel = "(canvas) => [...canvas.getContext('2d').getImageData(1, 1, 1, 1).data]"
    colour: list[int] = timeline(page).evaluate(pixel)
    return colour


def test_it_takes_the_colours_of_another_scheme_at_once(page: Page) -> None:
    # A pixel is a minute and a half there, and until then nothing else changes.
    page.get_by_role("button", name="24 h", exact=True).click()
    page.wait_for_timeout(1500)
    light = ground(page)
    page.emulate_media(color_scheme="dark")
    page.wait_for_timeout(1500)
    assert sum(ground(page)) < sum(light)


def look_at_a_minute(page: Page) -> None:
    page.get_by_role("button", name="1 min", exact=True).click()
    page.wait_for_function(
        "() => { const { ariaValueMax: end, ariaValueMin: begin } ="
        " document.querySelector('ph-timeline canvas'); return Math.abs(end - begin - 60) < 1; }"
    )


def table(page: Page) -> Locator:
    """Return the rows of the table twin."""
    button = page.get_by_role("button", name="Table", exact=True)
    if button.get_attribute("aria-pressed") != "true":
        button.click()
    return page.get_by_role("region", name="Table of the timeline").locator("tbody tr")


def happened_at(service: Service, kind: str) -> str:
    """Return the time of the last event of a kind."""
    at: str = service.request("GET", f"/events?kind={kind}&limit=1")["items"][0]["at"]
    return at


def place_of(page: Page, at: str, later_s: float = 0.0) -> float:
    """Return where a time is on the canvas, px."""
    begin, end, width = page.evaluate(
        """() => {
            const canvas = document.querySelector("ph-timeline canvas");
            const value = (name) => Number(canvas.getAttribute(name));
            return [value("aria-valuemin"), value("aria-valuemax"), canvas.clientWidth];
        }"""
    )
    time = datetime.fromisoformat(at).timestamp() + later_s
    return float((time - begin) / (end - begin) * width)


def span_s(page: Page) -> float:
    begin, end = (
        timeline(page).get_attribute(f"aria-value{name}") or "" for name in ("min", "max")
    )
    return float(end) - float(begin)


def change_mode(service: Service, mode: str) -> None:
    service.request("POST", "/systems/actuation/mode?wait=10", {"mode": mode})


def shown_mode(page: Page) -> Locator:
    return page.get_by_role("treeitem").filter(has_text="actuation").first


def test_pointing_at_a_bar_tells_what_it_was_and_how_long_it_lasted(
    page: Page, robot: Service, complaints: Complaints
) -> None:
    look_at_a_minute(page)
    robot.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    page.wait_for_timeout(1500)
    place = place_of(page, happened_at(robot, "hold.set"), later_s=0.5)

    timeline(page).hover(position={"x": place, "y": lane_y(page, "Holds")})

    expect(tip(page)).to_contain_text("Holds")
    expect(tip(page)).to_contain_text("hold gate: the gate is shut")
    expect(tip(page)).to_contain_text(re.compile(r"since \d\d:\d\d:\d\d, [\d.]+ s"))
    assert complaints.messages == []


def test_a_command_is_told_with_who_gave_it(page: Page, robot: Service) -> None:
    look_at_a_minute(page)
    robot.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    page.wait_for_timeout(1500)
    place = place_of(page, happened_at(robot, "hold.requested"))

    timeline(page).hover(position={"x": place, "y": lane_y(page, "Commands")})

    expect(tip(page)).to_contain_text("hold gate requested")
    expect(tip(page)).to_contain_text("by 127.0.0.1")


def test_a_press_shows_that_moment_in_all_panels_and_escape_goes_back_to_live(
    page: Page, robot: Service, complaints: Complaints
) -> None:
    change_mode(robot, "MODERATE")
    robot.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    page.wait_for_timeout(4000)
    held = happened_at(robot, "hold.set")
    change_mode(robot, "PERFORMANCE")
    robot.request("DELETE", "/holds/gate")
    expect(shown_mode(page)).to_contain_text("PERFORMANCE")
    look_at_a_minute(page)

    timeline(page).click(position={"x": place_of(page, held, later_s=2), "y": 20})

    expect(note(page)).to_have_text(re.compile("Loading"), timeout=100)
    expect(band(page)).to_be_visible(timeout=REPLAYED_MS)
    expect(shown_mode(page)).to_contain_text("MODERATE")
    expect(page.get_by_role("heading", level=1)).to_contain_text("IDLE")
    expect(page.get_by_role("button", name=re.compile("^STOP"))).to_be_enabled()

    page.keyboard.press("Escape")

    expect(band(page)).to_be_hidden()
    expect(shown_mode(page)).to_contain_text("PERFORMANCE")
    expect(page.get_by_role("button", name="Now", exact=True)).to_be_disabled()
    assert complaints.messages == []


def test_with_the_keys_alone_one_goes_from_event_to_event_and_shows_one(
    page: Page, robot: Service
) -> None:
    change_mode(robot, "MODERATE")
    page.wait_for_timeout(500)
    change_mode(robot, "PERFORMANCE")
    expect(shown_mode(page)).to_contain_text("PERFORMANCE")
    look_at_a_minute(page)
    page.wait_for_timeout(1200)

    expect(page.locator(".lane-names")).to_contain_text("actuation")

    timeline(page).focus()
    for _ in range(4):
        page.keyboard.press("ArrowDown")
    expect(timeline(page)).to_have_attribute("aria-valuetext", re.compile("actuation"))
    for _ in range(60):
        if "MODERATE" in (timeline(page).get_attribute("aria-valuetext") or ""):
            break
        page.keyboard.press("ArrowLeft")
    page.keyboard.press("Enter")

    expect(band(page)).to_be_visible(timeout=REPLAYED_MS)
    expect(shown_mode(page)).to_contain_text("MODERATE")
    first = band(page).inner_text()
    page.get_by_role("button", name="Show the previous event").click()
    expect(band(page)).not_to_have_text(first, timeout=REPLAYED_MS)
    band(page).get_by_role("button", name="Back to live").click()
    expect(band(page)).to_be_hidden()


def test_keys_zoom_and_move_and_end_follows_now_again(page: Page) -> None:
    timeline(page).focus()

    page.keyboard.press("+")
    expect(page.get_by_role("button", name="10 min")).to_have_attribute("aria-pressed", "false")
    assert span_s(page) == pytest.approx(300)
    page.keyboard.press("PageUp")
    expect(page.get_by_role("button", name="Now", exact=True)).to_be_enabled()
    page.keyboard.press("End")
    expect(page.get_by_role("button", name="Now", exact=True)).to_be_disabled()
    timeline(page).hover()
    page.mouse.wheel(0, 1000)
    page.wait_for_function(
        "() => { const { ariaValueMax: end, ariaValueMin: begin } ="
        " document.querySelector('ph-timeline canvas'); return end - begin > 1000; }"
    )


def test_a_hold_that_came_and_went_twenty_times_is_one_mark_with_its_number(
    page: Page, robot: Service
) -> None:
    for _ in range(20):
        robot.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
        robot.request("DELETE", "/holds/gate")
    page.get_by_role("button", name="24 h").click()
    page.wait_for_timeout(1500)
    place = place_of(page, happened_at(robot, "hold.set"))

    timeline(page).hover(position={"x": place, "y": lane_y(page, "Holds")})

    expect(tip(page)).to_contain_text(re.compile(r"[2-9]\d in holds"))
    expect(tip(page)).to_contain_text(re.compile(r"[2-9]\d \S gate"))


def test_between_two_runs_nothing_is_claimed_to_be_known(
    page: Page, robot: Service, complaints: Complaints
) -> None:
    page.wait_for_timeout(1000)
    robot.kill()
    page.wait_for_timeout(4000)
    robot.start()
    expect(page.locator("ph-state-bar")).not_to_contain_text("No contact", timeout=20_000)
    look_at_a_minute(page)
    page.wait_for_timeout(2000)
    begun = happened_at(robot, "service.restored")

    timeline(page).hover(
        position={"x": place_of(page, begun, later_s=-1.5), "y": lane_y(page, "State")}
    )

    expect(tip(page)).to_contain_text("the service did not run")
    told = table(page).filter(has_text="Service")
    expect(told.first).to_contain_text("the service did not run")
    for row in table(page).filter(has_text="State").all_inner_texts():
        assert not re.search(r"IDLE.*since .* [2-9]\d s", row)
    # The browser tells of the lost connection.
    complaints.messages.clear()


def test_the_table_has_in_words_what_the_lanes_show(page: Page, robot: Service) -> None:
    robot.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    robot.request("DELETE", "/holds/gate")
    page.wait_for_timeout(1200)

    rows = table(page)

    expect(rows.filter(has_text="hold gate: the gate is shut").first).to_be_visible()
    command = rows.filter(has_text="release of hold gate requested").first
    expect(command).to_contain_text("127.0.0.1")
    expect(command.get_by_role("rowheader")).to_have_text("Commands")


def test_the_time_of_an_event_in_the_log_shows_its_moment(page: Page, robot: Service) -> None:
    change_mode(robot, "MODERATE")
    robot.request("PUT", "/holds/loading", {"reason": "a pallet"})
    page.wait_for_timeout(300)
    change_mode(robot, "PERFORMANCE")
    expect(shown_mode(page)).to_contain_text("PERFORMANCE")
    page.get_by_role("tab", name="Log").click()

    page.get_by_role("listitem").filter(has_text="hold loading set").get_by_role(
        "button", name=re.compile("^Show|:")
    ).first.click()

    expect(page.get_by_role("tab", name="Timeline")).to_have_attribute("aria-selected", "true")
    expect(band(page)).to_be_visible(timeout=REPLAYED_MS)
    expect(shown_mode(page)).to_contain_text("MODERATE")


def test_from_an_error_one_gets_to_the_moment_in_which_it_was_raised(
    page: Page, robot: Service
) -> None:
    robot.request("PATCH", "/mock/battery_level", {"value": 0.3})
    page.wait_for_timeout(1500)

    page.get_by_role("button", name="Show on the timeline").first.click()

    expect(note(page)).to_have_text(re.compile("Loading"), timeout=100)
    expect(band(page)).to_be_visible(timeout=REPLAYED_MS)
    robot.make_healthy()
    expect(page.get_by_role("heading", level=1)).to_contain_text("IDLE")
    expect(page.locator("ph-why")).to_contain_text("BATTERY_LOW")


def test_a_lane_of_a_part_stays_when_it_is_kept(
    browser: "Browser", tmp_path: Path, complaints: Complaints
) -> None:
    with serving(tmp_path, large_robot(tmp_path)) as service:
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        complaints.watch(page)
        page.goto(service.url)
        names = page.locator(".lane-names")
        page.get_by_role("searchbox").fill("node_042")
        page.get_by_role("treeitem").filter(has_text="node_042").last.click()
        names.get_by_role("button", name="Keep the lane of node_042").click()
        page.get_by_role("searchbox").fill("node_050")
        page.get_by_role("treeitem").filter(has_text="node_050").last.click()

        expect(names.get_by_role("button", name="node_050", exact=True)).to_be_visible()
        expect(names.get_by_role("button", name="node_042", exact=True)).to_be_visible()
        names.get_by_role("button", name="Take the lane of node_042 away").click()
        expect(names.get_by_role("button", name="node_042", exact=True)).to_have_count(0)
        assert complaints.messages == []
        page.close()


def test_the_events_of_the_span_are_saved_as_json_lines(page: Page, robot: Service) -> None:
    robot.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    page.wait_for_timeout(500)

    with page.expect_download() as waiting:
        page.get_by_role("button", name="Export").click()

    path = Path(waiting.value.path())
    events: list[dict[str, Any]] = [json.loads(line) for line in path.read_text().splitlines()]
    assert waiting.value.suggested_filename.endswith(".jsonl")
    assert [event["id"] for event in events] == sorted(event["id"] for event in events)
    assert "hold.set" in [event["kind"] for event in events]
    expect(note(page)).to_have_text(f"Saved {len(events):,} events.")


def test_without_a_record_the_panels_stay_live_and_say_why(desktop: Page) -> None:
    timeline(desktop).click(position={"x": 300, "y": 20})

    expect(note(desktop)).to_contain_text("That moment is not shown: nothing is recorded")
    expect(note(desktop)).to_contain_text("Panels show now.")
    expect(band(desktop)).to_be_hidden()


def test_on_a_phone_a_tap_shows_a_moment(
    browser: "Browser", robot: Service, complaints: Complaints
) -> None:
    context = browser.new_context(viewport={"width": 360, "height": 640}, has_touch=True)
    page = context.new_page()
    complaints.watch(page)
    page.goto(robot.url)
    page.get_by_role("tab", name="Log").click()
    look_at_a_minute(page)
    page.wait_for_timeout(2500)

    timeline(page).tap(position={"x": place_of(page, now(robot), later_s=-2), "y": 30})

    expect(band(page)).to_be_visible(timeout=REPLAYED_MS)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert complaints.messages == []
    context.close()


def now(service: Service) -> str:
    at: str = service.request("GET", "/system_state")["at"]
    return at
