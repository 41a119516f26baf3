"""What an operator sees and may do while storage fails."""

import re
import time
from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Locator, Page, Route, expect

from tests.browser.station import Complaints, Service, serving

pytestmark = pytest.mark.browser

FORGETS = "; a restart may forget it"
REFUSED = {
    "title": "What must be on disk first cannot be written there",
    "status": 503,
    "code": "STORAGE_DEGRADED",
    "detail": "nothing was done, since it cannot be stored: the disk takes more than 2 s",
}


@pytest.fixture(scope="module")
def running_service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """Return a robot that keeps what happens, and whose e-stop wants acknowledging."""
    folder = tmp_path_factory.mktemp("kept")
    robot = folder / "robot.yaml"
    robot.write_text("signals: {estop: {recovery: acknowledge}}\n")
    with serving(folder, ("--robot", str(robot)), keeps=True) as service:
        yield service


@pytest.fixture
def service(running_service: Service) -> Iterator[Service]:
    running_service.make_healthy()
    yield running_service
    running_service.mend_storage()
    end = time.monotonic() + 10.0
    while running_service.request("GET", "/system_state")["storage_fault"]:
        assert time.monotonic() < end
        time.sleep(0.05)
    running_service.request("POST", "/errors/ESTOP/acknowledge")


def notice(page: Page) -> Locator:
    return page.locator("ph-notices .storage")


def break_storage(page: Page, service: Service) -> None:
    service.break_storage()
    expect(notice(page)).to_be_visible()


def press(button: Locator, page: Page) -> None:
    button.hover()
    page.mouse.down()
    page.wait_for_timeout(1300)
    page.mouse.up()


def owners(service: Service) -> list[str]:
    return [hold["owner"] for hold in service.request("GET", "/holds")["items"]]


def test_that_storage_fails_is_told_until_it_works_again_and_spoken_once(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    desktop.evaluate(
        """() => {
            window.spoken = [];
            const live = document.querySelector("ph-state-bar [aria-live=polite]");
            const note = () => window.spoken.push(live.textContent);
            new MutationObserver(note).observe(live, { childList: true });
        }"""
    )
    break_storage(desktop, service)
    expect(notice(desktop)).to_have_text(
        re.compile(r"^STORAGE FAILS: .+; a restart may forget what you ask now$")
    )
    desktop.wait_for_timeout(2500)
    # A page that is starved may also speak of its connection.
    spoken = desktop.evaluate("window.spoken")
    assert sum(words.count("STORAGE FAILS") for words in spoken) == 1
    service.mend_storage()
    expect(notice(desktop)).to_be_hidden(timeout=10_000)
    assert complaints.messages == []


def test_on_a_phone_it_is_seen_wherever_one_scrolls(phone: Page, service: Service) -> None:
    service.request("PUT", "/emergency_stop", {"engaged": True, "reason": "smoke in hall 3"})
    break_storage(phone, service)
    expect(phone.get_by_role("button", name=f"Release the stop (hold){FORGETS}")).to_be_visible()
    for end in ("0", "10000"):
        phone.evaluate(f"document.querySelector('main').scrollTo(0, {end})")
        expect(notice(phone)).to_be_in_viewport(ratio=1)
        assert notice(phone).evaluate("(band) => band.scrollHeight - band.clientHeight") <= 1
        expect(phone.get_by_role("button", name=re.compile("^STOP"))).to_be_in_viewport(ratio=1)
    assert phone.evaluate("document.documentElement.scrollWidth") == 360


def test_a_long_press_that_says_what_it_risks_releases_and_acknowledges_all_the_same(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    for pressed in (True, False):
        service.request("POST", "/signals/estop", {"value": pressed})
    service.request("PUT", "/emergency_stop", {"engaged": True, "reason": "smoke"})
    service.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    break_storage(desktop, service)

    press(desktop.get_by_role("button", name=f"Release the stop (hold){FORGETS}"), desktop)
    expect(desktop.get_by_role("button", name=re.compile("^STOP"))).to_have_text("STOP")
    expect(desktop.locator("ph-state-bar")).to_contain_text("Done; not on disk yet")
    notices = desktop.locator("ph-notices")
    press(notices.get_by_role("button", name=f"Acknowledge ESTOP (hold){FORGETS}"), desktop)
    expect(desktop.get_by_role("heading", level=1)).to_contain_text("IDLE")
    press(desktop.get_by_role("button", name=f"Release gate (hold){FORGETS}"), desktop)
    expect(desktop.get_by_role("list", name="Holds")).to_be_hidden()

    assert service.request("GET", "/emergency_stop")["engaged"] is False
    assert owners(service) == []
    assert complaints.messages == []


def test_who_can_only_click_is_told_the_risk_before_the_second_click(
    desktop: Page, service: Service
) -> None:
    service.request("PUT", "/holds/gate", {})
    break_storage(desktop, service)
    release = desktop.get_by_role("button", name=f"Release gate (hold){FORGETS}")
    expect(release).to_have_text("Release; may be forgotten")
    release.evaluate("(button) => button.click()")
    expect(release).to_have_text(f"Release gate (hold){FORGETS}: press again to confirm")
    release.evaluate("(button) => button.click()")
    expect(release).to_have_count(0)
    assert owners(service) == []


def test_a_press_that_began_before_storage_failed_risks_nothing(desktop: Page) -> None:
    risks = desktop.evaluate(
        """async () => {
            const button = document.createElement("ph-hold-button");
            document.body.append(button);
            const held = new Promise((resolve) => button.addEventListener("ph-held", resolve));
            button.button.dispatchEvent(new PointerEvent("pointerdown"));
            button.volatile = true;
            return (await held).detail.volatile;
        }"""
    )
    assert risks is False


def refuse_first(page: Page, path: str) -> list[Any]:
    """Answer requests that are not volatile as a disk that is too slow; return what was asked."""
    asked: list[Any] = []

    def answer(route: Route) -> None:
        body = route.request.post_data_json or {}
        asked.append((route.request.method, body))
        if "volatile=true" in route.request.url or "volatile" in body:
            route.continue_()
        else:
            # As long as the service waits for the disk.
            page.wait_for_timeout(2100)
            route.fulfill(status=503, json=REFUSED)

    page.route(path, answer)
    return asked


def test_a_stop_that_storage_does_not_let_go_is_told_and_can_be_released_at_once(
    desktop: Page, service: Service
) -> None:
    engaged = service.request("PUT", "/emergency_stop", {"engaged": True, "reason": "smoke"})
    shown = engaged["stops"][0]["id"]
    asked = refuse_first(desktop, "**/emergency_stop")
    press(desktop.get_by_role("button", name="Release the stop (hold)", exact=True), desktop)
    stop = desktop.locator("ph-stop-release")
    expect(stop).to_contain_text(f"Not released: {REFUSED['detail']}")
    expect(notice(desktop)).to_be_hidden()
    press(desktop.get_by_role("button", name=f"Release the stop (hold){FORGETS}"), desktop)
    expect(desktop.get_by_role("button", name=re.compile("^STOP"))).to_have_text("STOP")
    # It names the stop that was on show.
    body = {"engaged": False, "reason": "released on the monitor page", "stops": [shown]}
    assert asked == [("PUT", body), ("PUT", {**body, "volatile": True})]


def test_a_hold_that_storage_does_not_let_go_is_told_and_can_be_released_at_once(
    desktop: Page, service: Service
) -> None:
    service.request("PUT", "/holds/gate", {})
    asked = refuse_first(desktop, "**/holds/gate*")
    press(desktop.get_by_role("button", name="Release gate (hold)", exact=True), desktop)
    alert = desktop.locator("ph-hold-chips").get_by_role("alert")
    expect(alert).to_have_text(f"Not released: {REFUSED['detail']}")
    press(desktop.get_by_role("button", name=f"Release gate (hold){FORGETS}"), desktop)
    expect(alert).to_be_hidden()
    expect(desktop.get_by_role("list", name="Holds")).to_be_hidden()
    assert len(asked) == 2
    assert owners(service) == []


def test_what_is_on_disk_is_not_worth_a_word(desktop: Page, service: Service) -> None:
    service.request("PUT", "/holds/gate", {})
    press(desktop.get_by_role("button", name="Release gate (hold)", exact=True), desktop)
    expect(desktop.get_by_role("list", name="Holds")).to_be_hidden()
    expect(desktop.locator("ph-state-bar")).not_to_contain_text("on disk")
