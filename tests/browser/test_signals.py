"""The signals beside the inspector: what is urgent first, a minute of each, and a day on demand."""

import re
from collections.abc import Iterator
from urllib.parse import urlsplit

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Locator, Page, expect

from tests.browser.robots import many_signals_robot
from tests.browser.station import Complaints, Service, serving

pytestmark = pytest.mark.browser

MOTOR = "Motor 150 temperature"


def row(page: Page, name: str) -> Locator:
    return page.locator("ph-signal-list ph-signal-row").filter(has_text=name)


def rows(page: Page) -> Locator:
    return page.locator("ph-signal-list ph-signal-row:visible")


def button(page: Page, name: str) -> Locator:
    return row(page, name).get_by_role("button", name=re.compile(f"^{name}"))


def away(page: Page) -> None:
    """Take the pointer from the list, under which its order stays."""
    page.mouse.move(5, 5)


def height(shown: Locator) -> float:
    box = shown.bounding_box()
    assert box is not None
    return box["height"]


@pytest.fixture(scope="module")
def many(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    folder = tmp_path_factory.mktemp("many")
    with serving(folder, many_signals_robot(folder)) as service:
        yield service


def opened(browser: Browser, service: Service, complaints: Complaints) -> Page:
    page = browser.new_page(viewport={"width": 1440, "height": 900})
    complaints.watch(page)
    page.goto(service.url)
    expect(row(page, "Battery")).to_contain_text("OK")
    return page


def test_each_signal_is_a_line_with_its_state_its_value_and_its_last_minute(
    desktop: Page, complaints: Complaints
) -> None:
    for name, value in (("Battery", "90 %"), ("GPS accuracy", "20 mm"), ("Temperature", "30.0 °C")):
        expect(row(desktop, name)).to_contain_text(value)
        expect(row(desktop, name)).to_contain_text("OK")
        expect(row(desktop, name).locator(".spark-line")).to_have_attribute("d", re.compile("^M"))
        expect(row(desktop, name).locator(".spark-limit")).to_have_attribute("d", re.compile("^M0"))
    # What is no number is a bar.
    bar = row(desktop, "Radio signal").locator(".spark-bar")
    expect(bar).to_have_attribute("d", re.compile("^M"))
    # A robot of few parts and few signals has room for taller lines.
    assert height(button(desktop, "Battery")) == 52
    assert complaints.messages == []


def test_bad_gps_is_seen_coming_in_a_ring_that_fills_and_stands_above_what_is_good(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    away(desktop)
    service.request("PATCH", "/mock/gps_accuracy", {"value": 250})
    gps = row(desktop, "GPS accuracy")
    expect(gps).to_contain_text(re.compile(r"GPS_LOST in 1\d s"))
    expect(gps).to_contain_text(re.compile(r"\d of 15 s"))
    expect(rows(desktop).first).to_contain_text("GPS accuracy")
    ring = gps.locator(".signal-shape g")
    expect(ring).to_have_attribute("stroke-dasharray", re.compile(r"^([1-9]|1\d) 100$"))
    expect(ring).to_have_attribute("stroke-dasharray", re.compile(r"^[23]\d 100$"), timeout=10_000)
    expect(desktop.get_by_role("heading", level=1)).to_have_text("IDLE: no task")
    assert complaints.messages == []


def test_what_is_wrong_with_a_signal_is_not_cut_off_where_there_is_room(
    browser: Browser, service: Service, complaints: Complaints
) -> None:
    page = opened(browser, service, complaints)
    service.request("PATCH", "/mock/gps_accuracy", {"value": 250})
    service.request("PATCH", "/mock/temperature", {"value": 60})
    service.request("PUT", "/emergency_stop", {"engaged": True, "reason": "smoke"})
    expect(row(page, "E-stop signal")).to_contain_text("signal: not pressed")
    expect(row(page, "GPS accuracy")).to_contain_text("GPS_LOST in")
    expect(row(page, "Temperature")).to_contain_text("TEMPERATURE_HIGH")
    cut = """(words) => words.filter((word) => word.scrollWidth > word.clientWidth)
        .map((word) => word.textContent)"""
    assert page.locator("ph-signal-row :is(.signal-word, .age)").evaluate_all(cut) == []
    page.close()


def test_an_error_comes_first_and_shades_its_time_and_goes_back_when_it_is_over(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    away(desktop)
    service.request("PATCH", "/mock/temperature", {"value": 60})
    hot = row(desktop, "Temperature")
    expect(rows(desktop).first).to_contain_text("TEMPERATURE_HIGH")
    expect(hot).to_have_attribute("data-level", "error")
    expect(hot.locator(".spark-bad")).to_have_attribute("d", re.compile("^M"))
    expect(desktop.locator(".signal-count")).to_have_text(re.compile("1 error"))
    service.request("PATCH", "/mock/temperature", {"value": 30})
    expect(hot).to_contain_text("OK")
    expect(rows(desktop).last).to_contain_text("Temperature")
    assert complaints.messages == []


def test_the_order_does_not_change_under_a_pointer(desktop: Page, service: Service) -> None:
    # Until the modes above are there, the list moves.
    expect(desktop.get_by_role("radio", name="PERFORMANCE")).to_be_visible()
    button(desktop, "Battery").hover()
    # An error would move the whole list, since its reason is told above.
    service.request("PATCH", "/mock/gps_accuracy", {"value": 250})
    expect(row(desktop, "GPS accuracy")).to_contain_text("GPS_LOST in ")
    desktop.wait_for_timeout(1500)
    expect(rows(desktop).nth(2)).to_contain_text("GPS accuracy")
    away(desktop)
    expect(rows(desktop).first).to_contain_text("GPS accuracy")


def test_a_signal_that_is_no_longer_published_is_stale_and_tells_its_age(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    temperature = row(desktop, "Temperature")
    expect(temperature.locator(".age")).to_be_hidden()
    service.request("PATCH", "/mock/temperature", {"publishing": False})
    expect(temperature).to_contain_text("stale")
    expect(temperature).to_contain_text(re.compile(r"[2-9]\.\d s old"))
    expect(temperature).to_have_attribute("data-level", "stale")
    assert complaints.messages == []


def test_a_row_opens_to_its_history_its_limits_and_a_table_of_it(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    service.request("PATCH", "/mock/battery_level", {"value": 0.7})
    expect(row(desktop, "Battery")).to_contain_text("70 %")
    button(desktop, "Battery").click()
    detail = row(desktop, "Battery").locator("ph-signal-detail")
    expect(button(desktop, "Battery")).to_have_attribute("aria-expanded", "true")
    expect(detail).to_contain_text(re.compile(r"70 % to (90|100) % in 10 min"))
    expect(detail).to_contain_text("BATTERY_LOW")
    expect(detail).to_contain_text("when below 50 %")
    expect(detail).to_contain_text("0 % to 100 %")
    expect(detail.locator(".chart-line")).to_have_attribute("d", re.compile("^M"))
    expect(detail.locator(".chart-labels .is-limit")).to_have_text("50 %")
    asked: list[str] = []
    desktop.on("request", lambda request: asked.append(request.url))
    detail.get_by_role("button", name="24 h").click()
    expect(detail).to_contain_text("in 24 h")
    assert any("/signals/battery_level/history?" in url for url in asked)
    detail.get_by_text("As a table").click()
    table = detail.get_by_role("table", name="Battery: history")
    expect(table.get_by_role("row").nth(1)).to_contain_text(" %")
    button(desktop, "Temperature").click()
    expect(detail).to_have_count(0)
    expect(row(desktop, "Temperature")).to_contain_text("when above 55.0 °C")
    button(desktop, "Temperature").click()
    expect(desktop.locator("ph-signal-detail")).to_have_count(0)
    assert complaints.messages == []


def test_a_keyboard_walks_through_the_rows_and_opens_one(desktop: Page) -> None:
    rows(desktop).first.get_by_role("button").focus()
    desktop.keyboard.press("End")
    desktop.keyboard.press("ArrowUp")
    names = rows(desktop).all_inner_texts()
    focused = desktop.evaluate("document.activeElement.closest('ph-signal-row').innerText")
    assert focused == names[-2]
    desktop.keyboard.press("Enter")
    expect(rows(desktop).nth(3).locator("ph-signal-detail")).to_be_visible()
    stops = desktop.locator("ph-signal-list button.signal[tabindex='0']")
    expect(stops).to_have_count(1)


def test_of_two_hundred_signals_only_those_in_sight_are_drawn_and_a_filter_finds_one(
    browser: Browser, many: Service, complaints: Complaints
) -> None:
    asked: list[str] = []
    page = browser.new_page(viewport={"width": 1440, "height": 900})
    complaints.watch(page)
    page.on("request", lambda request: asked.append(urlsplit(request.url).path))
    page.goto(many.url)
    expect(page.locator(".signal-count")).to_contain_text("206")
    drawn = page.locator("ph-signal-list ph-sparkline")
    expect(drawn).not_to_have_count(0)
    assert drawn.count() < 60
    assert height(rows(page).first.get_by_role("button")) == 32
    histories = [path for path in asked if path.endswith("/history")]
    assert len(histories) == len(set(histories)) < 60
    search = page.get_by_role("searchbox", name="Filter signals")
    search.fill("motor 15")
    expect(rows(page)).to_have_count(10)
    expect(page.locator(".signal-count")).to_contain_text("10 of 206")
    many.request("POST", "/signals/motor_150_temperature", {"value": 85.5})
    expect(row(page, MOTOR)).to_contain_text("85.5 °C")
    expect(row(page, MOTOR)).to_contain_text("HOT_150")
    # It is urgent: the header asks for attention, and Why has it once, among its errors.
    expect(page.locator("ph-state-bar")).to_contain_text("HOT_150: motor_150_temperature 85.5 °C")
    expect(page.locator("ph-why .others")).not_to_contain_text("HOT_150")
    search.fill("nothing")
    expect(page.get_by_text("No signal is called “nothing”.")).to_be_visible()
    search.fill("")
    expect(rows(page).first).to_contain_text(MOTOR)
    assert complaints.messages == []
    page.close()


def test_a_monitor_tells_of_what_it_is_computed_and_a_limit_where_it_ends(
    browser: Browser, many: Service, complaints: Complaints
) -> None:
    page = opened(browser, many, complaints)
    many.request("POST", "/signals/motor_150_temperature", {"value": 60.0})
    page.get_by_role("searchbox", name="Filter signals").fill("mean")
    button(page, "Mean of motor 0").click()
    expect(row(page, "Mean of motor 0")).to_contain_text("mean of Motor 000 temperature, over 10 s")
    page.get_by_role("searchbox", name="Filter signals").fill("150")
    button(page, MOTOR).click()
    expect(row(page, MOTOR)).to_contain_text("when above 80.0 °C, ends at 70.0 °C")
    # Its label is cut in the middle; nothing else tells on a phone which one it is.
    expect(row(page, MOTOR).locator(".signal-facts")).to_contain_text("motor_150_temperature")
    assert complaints.messages == []
    page.close()


def test_a_history_that_does_not_come_is_told_in_a_sentence_that_fits(desktop: Page) -> None:
    desktop.route("**/battery_level/history?*", lambda route: route.abort())
    button(desktop, "Battery").click()
    told = "No history: the service did not answer."
    expect(row(desktop, "Battery").get_by_text(told, exact=True)).to_be_visible()


def test_without_contact_the_line_of_a_signal_ends_and_nothing_is_ok(
    desktop: Page, service: Service
) -> None:
    expect(row(desktop, "Battery")).to_contain_text("OK")
    desktop.context.set_offline(True)
    service.kill()
    try:
        expect(row(desktop, "Battery")).to_contain_text("no contact", timeout=10_000)
        expect(row(desktop, "Battery")).to_contain_text(re.compile(r"\d s old"))
        line = row(desktop, "Battery").locator(".spark-line")
        # Seconds of silence at its end have no value.
        expect(line).not_to_have_attribute("d", re.compile(r"[ML]59\.5 "))
        expect(desktop.locator("ph-signal-list")).not_to_contain_text("OK")
    finally:
        desktop.context.set_offline(False)
        service.start()
