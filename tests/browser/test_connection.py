"""The page never shows old values as if they were of now, and catches up by itself."""

import re
import time
from collections import deque

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Page, WebSocketRoute, expect

from tests.browser.places import header, sentence, stop
from tests.browser.station import Service

pytestmark = pytest.mark.browser

BACK_MS = 15_000
FROZEN_MS = 60_000
SHOWN = """() => ["h1", "#parts", "#signals .value", ".chips-holds"]
    .map((place) => [...document.querySelectorAll(place)].map((node) => node.innerText))"""


def test_a_stream_that_falls_silent_is_late_after_1_s_and_lost_after_3_s(
    browser: Browser, service: Service
) -> None:
    page = browser.new_page()
    is_silent: list[bool] = []
    sent: deque[float] = deque(maxlen=1)

    def between(socket: WebSocketRoute) -> None:
        server = socket.connect_to_server()

        def pass_on(message: str | bytes) -> None:
            if is_silent:
                return
            sent.append(1000 * time.time())
            socket.send(message)

        server.on_message(pass_on)

    page.route_web_socket("**/ws*", between)
    page.goto(service.url)
    expect(sentence(page)).to_contain_text("IDLE")
    page.evaluate(
        """() => {
            window.levels = [];
            const note = () => {
                const level = document.body.dataset.contact;
                if (window.levels.at(-1)?.[0] === level) return;
                window.levels.push([level, performance.timeOrigin + performance.now()]);
            };
            new MutationObserver(note).observe(document.body, { attributes: true });
            note();
        }"""
    )
    # What the page shows first came with it, not over the stream.
    while not sent:
        page.wait_for_timeout(20)
    is_silent.append(True)
    expect(sentence(page)).to_have_text(re.compile(r"^No contact for \d s: "))
    came = {level: at - sent[0] for level, at in page.evaluate("window.levels")}
    assert 900 <= came["late"] <= 2900
    assert 2900 <= came["lost"] <= 5000
    expect(header(page)).to_have_attribute("data-level", "lost")
    page.close()


def test_a_network_that_is_cut_leaves_grey_values_and_a_stop_that_says_it_is_not_delivered(
    desktop: Page, service: Service
) -> None:
    expect(desktop.locator("ph-signal-row").first).to_contain_text("OK", timeout=BACK_MS)
    desktop.context.set_offline(True)
    expect(sentence(desktop)).to_contain_text("No contact for ", timeout=BACK_MS)
    expect(desktop.locator("#signals")).not_to_contain_text("OK")
    assert "grayscale(1)" in desktop.evaluate(
        "getComputedStyle(document.querySelector('main')).filter"
    )
    stop(desktop).click()
    alarm = desktop.get_by_role("alert").filter(has_text="Not delivered. Use the hardware stop.")
    expect(alarm).to_be_visible()
    expect(header(desktop).get_by_role("button", name="Try now")).to_be_visible()
    expect(header(desktop)).to_contain_text(re.compile(r"Next attempt in \d s|Connecting"))
    assert service.request("GET", "/emergency_stop")["engaged"] is False

    desktop.context.set_offline(False)

    # The press is not forgotten, and there is no reload.
    expect(stop(desktop)).to_contain_text("ENGAGED", timeout=BACK_MS)
    expect(alarm).to_be_hidden()
    expect(header(desktop).locator(".contact")).to_contain_text("Connected", timeout=BACK_MS)
    assert service.request("GET", "/emergency_stop")["engaged"] is True


def test_a_service_that_comes_back_is_announced_within_the_page(
    desktop: Page, service: Service
) -> None:
    desktop.evaluate("window.isSame = true")
    service.kill()
    expect(sentence(desktop)).to_contain_text("No contact for ")
    service.start()
    expect(desktop.locator("ph-notices .notice")).to_contain_text(
        re.compile(r"Started again at \d\d:\d\d:\d\d"), timeout=2 * BACK_MS
    )
    expect(sentence(desktop)).to_contain_text("IDLE")
    assert desktop.evaluate("window.isSame") is True


@pytest.mark.timeout(240)
def test_of_two_pages_the_one_that_was_frozen_for_60_s_shows_the_same_afterwards(
    browser: Browser, service: Service
) -> None:
    pages = [browser.new_context().new_page() for _ in range(2)]
    for page in pages:
        page.goto(service.url)
        expect(page.locator("ph-signal-row").first).to_contain_text("OK", timeout=BACK_MS)
    frozen = pages[0].context.new_cdp_session(pages[0])
    frozen.send("Page.setWebLifecycleState", {"state": "frozen"})
    service.request("POST", "/systems/actuation/mode?wait=15", {"mode": "PERFORMANCE"})
    service.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    service.request("PATCH", "/mock/battery_level", {"value": 0.1})
    pages[1].wait_for_timeout(FROZEN_MS)
    frozen.send("Page.setWebLifecycleState", {"state": "active"})
    for page in pages:
        expect(sentence(page)).to_contain_text("ERROR: battery 10 %", timeout=BACK_MS)
        expect(header(page).locator(".contact")).to_contain_text("Connected", timeout=BACK_MS)
    ages = re.compile(r"\d+ s|\d+ min")
    shown = [ages.sub("", str(page.evaluate(SHOWN))) for page in pages]
    assert shown[0] == shown[1]
    for page in pages:
        page.context.close()
