"""A robot of several computers on the page, as an operator meets it.

What the supervisor tells of its devices is put into the frames of a robot of one computer, so that
a device is lost when a test wants it lost.
"""

import json
import re
from collections.abc import Callable
from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Page, WebSocketRoute, expect

from tests.browser.states import told_of_devices
from tests.browser.station import Complaints, Service
from tests.support.monitor import this_device

pytestmark = pytest.mark.browser

Told = Callable[[], dict[str, Any]]


def tell(page: Page, told: Told) -> None:
    """Open the page anew, and put members into each frame that it gets from now on."""

    def between(browser: WebSocketRoute) -> None:
        server = browser.connect_to_server()

        def pass_on(message: str | bytes) -> None:
            frame = json.loads(message)
            if frame["type"] == "state":
                frame.update(told())
            browser.send(json.dumps(frame))

        server.on_message(pass_on)

    page.route_web_socket("**/ws*", between)
    page.reload()


def told_of(service: Service, *, lost: bool) -> dict[str, Any]:
    items = [
        item
        for kind in ("systems", "nodes")
        for item in service.request("GET", f"/{kind}")["items"]
    ]
    return told_of_devices({item["name"]: item for item in items}, lost=lost)


def row(page: Page, part: str) -> Any:  # noqa: ANN401 - a locator
    return page.get_by_role("treeitem", name=re.compile(f"^{part} "))


def test_each_part_says_on_which_device_it_is_and_what_that_does_when_it_is_cut_off(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    told = told_of(service, lost=False)
    tell(desktop, lambda: told)

    expect(row(desktop, "manipulator").locator(".on-device")).to_have_text("arm")
    row(desktop, "drive_base").click()

    expect(desktop.locator("ph-part-device")).to_have_text(
        "On device base. When cut off for 2 s, drive_base goes to inactive, its reactions act."
    )
    expect(desktop.locator(".chip[data-kind=device]")).to_have_count(0)
    assert complaints.messages == []


def test_the_chip_of_a_lost_device_leads_to_its_parts_which_are_as_they_were_and_old(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    told = told_of(service, lost=True)
    tell(desktop, lambda: told)
    expect(desktop.get_by_role("heading", level=1)).to_have_text(
        "IDLE: device arm is lost; no task"
    )

    desktop.get_by_role("button", name="arm lost").click()

    option = desktop.get_by_role("option", name=re.compile("^manipulator "))
    expect(option).to_be_focused()
    expect(option.locator(".fit")).to_contain_text("STRONG")
    expect(option.locator(".age")).to_have_text(re.compile(r"^\d+ s$"))
    option.click()
    expect(desktop.locator("ph-part-device .old")).to_contain_text("has not been heard since")
    expect(desktop.locator("ph-part-device .old")).to_contain_text("It was active.STRONG then.")
    assert complaints.messages == []


def test_stop_says_which_device_it_may_not_reach_and_afterwards_which_may_go_on(
    desktop: Page, service: Service
) -> None:
    told = told_of(service, lost=True)
    tell(desktop, lambda: told)
    stop = desktop.locator("ph-stop-button")
    expect(stop.locator(".unheard")).to_have_text("STOP may not reach arm")

    desktop.get_by_role("button", name="STOP", exact=True).click()

    expect(stop.locator(".unheard")).to_have_text("arm is not known to be stopped")
    expect(desktop.locator("ph-stop-release")).to_contain_text("arm is not known to be stopped")


def test_the_page_of_a_device_says_whose_word_counts_as_that_changes(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    del service
    lead = ["supervisor"]
    tell(desktop, lambda: {"this_device": this_device("arm", lead[0])})
    chip = desktop.locator(".chip.badge").filter(has_text="DEVICE")
    expect(chip).to_have_text("DEVICE arm: the supervisor's word counts")

    lead[0] = "device"

    expect(chip).to_have_text("DEVICE arm: acts alone")
    assert complaints.messages == []


def test_a_device_shows_neither_map_nor_task_which_are_the_supervisors(
    desktop: Page, phone: Page, service: Service
) -> None:
    del service
    for page in (desktop, phone):
        tell(page, lambda: {"this_device": this_device("arm", "supervisor")})
        expect(page.locator("#map")).to_be_hidden()
    expect(desktop.locator("#log")).to_be_visible()

    phone.get_by_role("tab", name="Status").focus()
    phone.keyboard.press("ArrowRight")

    expect(phone.get_by_role("tab", name="Parts")).to_be_focused()
    expect(phone.get_by_role("tab", name="Map")).to_have_count(0)


def test_on_a_phone_the_band_of_the_stop_names_the_lost_device(
    phone: Page, service: Service
) -> None:
    service.request("PUT", "/emergency_stop", {"engaged": True, "reason": "smoke"})
    told = told_of(service, lost=True)
    tell(phone, lambda: told)

    expect(phone.locator("ph-stop-release")).to_contain_text("arm is not known to be stopped")
