"""The header: one line that says what the robot is in, chips, STOP and its way, the menu."""

import re
from collections.abc import Callable

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Locator, Page, Route, expect

from tests.browser.places import header, sentence, stop
from tests.browser.states import aborted, drive, patched
from tests.browser.station import Complaints, Service

pytestmark = pytest.mark.browser

SLOW_MS = 10_000
HEIGHT_PX = 72


def press(button: Locator, page: Page) -> None:
    button.hover()
    page.mouse.down()
    page.wait_for_timeout(1300)
    page.mouse.up()


def held(page: Page, service: Service) -> None:
    drive(service)
    service.request("PUT", "/holds/gate", {"reason": "the gate is shut " * 9})


def low(_: Page, service: Service) -> None:
    service.request("PATCH", "/mock/battery_level", {"value": 0.1})


def silent(_: Page, service: Service) -> None:
    service.kill()


@pytest.mark.parametrize(
    ("act", "level", "said"),
    [
        (lambda *_: None, "calm", "IDLE: no task"),
        (held, "held", "HELD: task"),
        (patched(aborted), "aborted", "ABORTED: task t7 was aborted"),
        (low, "error", "ERROR: battery 10 % is below 50 %"),
        (silent, "lost", "No contact for "),
    ],
)
def test_the_whole_header_has_the_colour_of_the_level_and_never_grows(
    desktop: Page, service: Service, act: Callable[[Page, Service], None], level: str, said: str
) -> None:
    calm = header(desktop).evaluate("(node) => getComputedStyle(node).background")
    act(desktop, service)
    expect(sentence(desktop)).to_contain_text(said, timeout=SLOW_MS)
    expect(header(desktop)).to_have_attribute("data-level", level)
    box = header(desktop).bounding_box()
    assert box is not None
    assert box["height"] == HEIGHT_PX
    ground = header(desktop).evaluate("(node) => getComputedStyle(node).background")
    assert (ground == calm) == (level == "calm")
    # What has no room is in the title.
    whole = sentence(desktop).get_attribute("title")
    assert whole is not None
    assert whole.startswith(sentence(desktop).inner_text()[:40])
    if level == "lost":
        service.start()


def test_what_the_sentence_has_no_room_for_is_one_press_away(
    desktop: Page, service: Service
) -> None:
    service.request("PATCH", "/mock/battery_level", {"value": 0.1})
    service.request("PATCH", "/mock/temperature", {"value": 90})
    more = header(desktop).get_by_role("button", name="+1 more")
    expect(more).to_be_visible()
    more.click()
    why = desktop.locator("#why")
    expect(why).to_contain_text("TEMPERATURE_HIGH")
    assert why.evaluate("(node) => node.contains(document.activeElement)")


def test_several_holds_are_counted_and_all_of_them_are_released_from_one_list(
    desktop: Page, service: Service
) -> None:
    for owner in ("gate", "loading", "operator"):
        service.request("PUT", f"/holds/{owner}", {"reason": f"why {owner}"})
    chips = desktop.get_by_role("list", name="Holds").get_by_role("listitem")
    expect(chips).to_have_count(2)
    desktop.get_by_role("button", name="3 holds").click()
    sheet = desktop.locator(".sheet").get_by_role("listitem")
    expect(sheet).to_have_count(3)
    expect(sheet.last).to_contain_text(re.compile(r"operator: why operator.*for \d+ s, by "))
    press(sheet.last.get_by_role("button", name="Release operator (hold)"), desktop)
    expect(sheet).to_have_count(2)
    assert len(service.request("GET", "/holds")["items"]) == 2


def test_a_part_that_deviates_is_counted_and_a_press_shows_it(
    desktop: Page, service: Service
) -> None:
    service.request("POST", "/systems/actuation/mode?wait=15", {"mode": "MODERATE"})
    speed = {"max_speed": 0.9}
    service.request("PATCH", "/nodes/drive_base/parameters?wait=15", speed)
    chip = header(desktop).get_by_role("button", name="1 of 3 deviates")
    expect(chip).to_be_visible(timeout=SLOW_MS)
    chip.click()
    parts = desktop.locator("#parts")
    assert parts.evaluate("(node) => node.contains(document.activeElement)")
    expect(parts.get_by_role("radio", name=re.compile("^Attention"))).to_be_checked()


def test_a_stop_tells_each_of_its_steps_with_its_time_and_is_released_with_a_reason(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    stop(desktop).click()
    steps = header(desktop).get_by_role("list", name="Emergency stop").get_by_role("listitem")
    expect(steps.nth(0)).to_have_text(re.compile(r"^SENT\d\d:\d\d:\d\d$"))
    expect(steps.nth(1)).to_have_text(re.compile(r"^ACKNOWLEDGED\+\d+\.\d+ s$"), timeout=SLOW_MS)
    expect(steps.nth(2)).to_have_text(re.compile(r"^STANDSTILL\+\d+\.\d+ s$"), timeout=SLOW_MS)
    box = header(desktop).bounding_box()
    assert box is not None
    assert box["height"] == HEIGHT_PX
    desktop.get_by_label("Reason for the release").fill("the smoke was steam")
    press(desktop.get_by_role("button", name="Release the stop (hold)"), desktop)
    expect(stop(desktop)).to_have_text("STOP")
    expect(steps).to_have_count(0)
    told = service.request("GET", "/events?limit=20&kind=emergency_stop.*")["items"]
    assert "the smoke was steam" in str(told)
    assert complaints.messages == []


def test_a_stop_of_somebody_else_says_when_it_was_engaged(desktop: Page, service: Service) -> None:
    service.request("PUT", "/emergency_stop", {"engaged": True, "reason": "smoke in hall 3"})
    steps = header(desktop).get_by_role("list", name="Emergency stop").get_by_role("listitem")
    expect(steps.first).to_have_text(re.compile(r"^ENGAGED\d\d:\d\d:\d\d$"))
    expect(desktop.locator("ph-stop-release")).to_contain_text("smoke in hall 3")


def test_a_stop_on_a_lost_device_says_where_it_has_to_be_released(
    desktop: Page, service: Service
) -> None:
    at = "2026-01-01T00:00:00.000Z"
    stop_there = {"id": "arm-7", "device": "arm", "by": "bert", "reason": "smoke", "since_at": at}
    latch = {"engaged": True, "by": "bert", "reason": "smoke", "since_at": at}
    latch |= {"standstill_at": None, "stops": [stop_there], "waits_for": [], "not_heard": ["arm"]}
    patched(lambda frame: frame.update(emergency_stop=latch))(desktop, service)
    asked: list[object] = []

    def answer(route: Route) -> None:
        asked.append(route.request.post_data_json)
        route.fulfill(json=latch)

    desktop.route("**/emergency_stop", answer)
    band = desktop.locator("ph-stop-release")
    expect(band).to_contain_text("Emergency stop engaged at device arm (not heard) at ")
    press(band.get_by_role("button", name="Release the stop (hold)"), desktop)
    expect(band.get_by_role("alert")).to_have_text(
        "Still engaged at device arm (not heard). Release it there.", timeout=SLOW_MS
    )
    reason = "released on the monitor page"
    assert asked == [{"engaged": False, "reason": reason, "stops": ["arm-7"]}]


def test_a_scheme_is_chosen_and_kept_over_a_reload(desktop: Page) -> None:
    ground = "getComputedStyle(document.body).backgroundColor"
    light = desktop.evaluate(ground)
    desktop.get_by_role("button", name="Menu").click()
    desktop.get_by_role("radio", name="Dark").check(force=True)
    dark = desktop.evaluate(ground)
    assert dark != light
    desktop.reload()
    assert desktop.evaluate(ground) == dark
    desktop.get_by_role("button", name="Menu").click()
    expect(desktop.get_by_role("radio", name="Dark")).to_be_checked()
    desktop.get_by_role("radio", name="System").check(force=True)
    assert desktop.evaluate(ground) == light
    assert desktop.evaluate("localStorage.length") == 0


def test_the_menu_leads_to_the_documents_of_the_interface(desktop: Page) -> None:
    desktop.get_by_role("button", name="Menu").click()
    desktop.get_by_role("link", name="API: requests and stream").click()
    expect(desktop).to_have_url(re.compile("/docs"))


def test_the_connection_tells_its_round_trip(desktop: Page) -> None:
    contact = header(desktop).locator(".contact")
    expect(contact).to_contain_text(re.compile(r"Connected\d+ ms"), timeout=SLOW_MS)
    expect(contact).to_have_attribute(
        "title", re.compile(r"Round trip \d+ ms; \d+ frames? skipped")
    )
