"""Why: the errors of the robot, as an operator reads them and uses them."""

import re
from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Locator, Page, expect

from tests.browser.station import Complaints, Service, serving
from tests.support.shared import PROJECT

pytestmark = pytest.mark.browser

ROBOT = """\
signals:
  estop: {recovery: acknowledge}
  load: {above: 250.0, unit: kg, error: OVERLOAD, stale_after_s: 0, min_on_s: 0}
"""


@pytest.fixture(scope="module")
def running_service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """Return a robot whose e-stop wants acknowledging, and that has a load."""
    folder = tmp_path_factory.mktemp("errors")
    robot = folder / "robot.yaml"
    robot.write_text(ROBOT)
    with serving(folder, ("--robot", str(robot))) as service:
        yield service


@pytest.fixture
def service(running_service: Service) -> Service:
    load(running_service, 0)
    running_service.make_healthy()
    return running_service


def load(service: Service, *values_kg: float) -> None:
    for value in values_kg:
        service.request("POST", "/signals/load", {"value": value})


def section(page: Page) -> Locator:
    return page.locator("ph-why")


def alarm(page: Page, name: str) -> Locator:
    return section(page).locator("ph-alarm").filter(has_text=name)


def shelve(page: Page, name: str, reason: str) -> None:
    alarm(page, name).get_by_role("button", name="Shelve").click()
    alarm(page, name).get_by_label("Reason").fill(reason)
    alarm(page, name).get_by_role("button", name="1 h").click()


def test_a_robot_that_is_well_says_so_in_one_line(desktop: Page) -> None:
    expect(section(desktop)).to_contain_text("Nothing is wrong")
    expect(section(desktop).locator("ph-alarm")).to_have_count(0)


def test_the_worst_is_open_and_says_what_it_means_and_what_can_be_done(
    desktop: Page, service: Service
) -> None:
    load(service, 300)
    worst = alarm(desktop, "OVERLOAD")
    expect(worst).to_contain_text("Load 300 kg is above 250 kg")
    expect(worst).to_contain_text("Critical: the task cannot go on")
    expect(worst.locator(".age")).to_have_text(re.compile(r"^\d+ s$"))
    expect(worst.locator("ph-sparkline")).to_be_visible()
    expect(worst.get_by_role("button", name="Acknowledge (hold)")).to_be_visible()
    expect(worst.get_by_role("button", name="Show on the timeline")).to_be_visible()


def test_an_error_came_first_only_if_there_are_others(desktop: Page, service: Service) -> None:
    load(service, 300)
    expect(alarm(desktop, "OVERLOAD").locator(".alarm-body")).to_be_visible()
    expect(section(desktop)).not_to_contain_text(re.compile("first|before the others"))
    service.request("PATCH", "/mock/battery_level", {"value": 0.1})
    expect(alarm(desktop, "OVERLOAD").locator(".tags")).to_have_text("first")
    expect(alarm(desktop, "OVERLOAD")).to_contain_text("it came before the others")


def test_an_error_leads_to_the_moment_when_it_began(desktop: Page, service: Service) -> None:
    load(service, 300)
    desktop.evaluate(
        """() => document.addEventListener("ph-show-moment", ({ detail }) => {
            window.at = detail.at;
        })"""
    )
    alarm(desktop, "OVERLOAD").get_by_role("button", name="Show on the timeline").click()
    since = error_of(service)["since_at"]
    assert desktop.evaluate("(since) => window.at === Date.parse(since)", since)


def test_who_selects_a_part_has_the_errors_closed_above_it_until_why_is_asked_for(
    desktop: Page, service: Service
) -> None:
    load(service, 300)
    opened = alarm(desktop, "OVERLOAD").locator("details").first
    expect(opened).to_have_attribute("open", "")
    desktop.get_by_role("treeitem").filter(has_text="drive_base").last.click()
    expect(opened).not_to_have_attribute("open", "")
    expect(alarm(desktop, "OVERLOAD")).to_contain_text("Load 300 kg is above 250 kg")
    expect(desktop.locator("ph-part-panel h2")).to_be_in_viewport()
    service.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    desktop.get_by_role("button", name="+1 more: why").click()
    expect(opened).to_have_attribute("open", "")
    further = desktop.get_by_role("list", name="Further reasons")
    expect(further).to_have_text("also held by gate (the gate is shut)")


def test_a_critical_error_is_in_the_title_until_somebody_acknowledged_it(
    desktop: Page, service: Service
) -> None:
    icon = desktop.locator("link[rel=icon]")
    expect(icon).to_have_attribute("href", re.compile("icon.svg"))
    load(service, 300)
    expect(desktop).to_have_title("(1) ERROR · Pilothouse")
    expect(icon).to_have_attribute("href", re.compile("icon_alarm.svg"))
    address = icon.get_attribute("href")
    assert desktop.evaluate("async (url) => (await fetch(url)).status", address) == 200
    held = alarm(desktop, "OVERLOAD").get_by_role("button", name="Acknowledge (hold)")
    held.click(delay=1200)
    expect(desktop).to_have_title("ERROR · Pilothouse")
    expect(icon).to_have_attribute("href", re.compile("icon.svg"))


def test_an_error_that_is_over_stays_dimmed_until_somebody_has_seen_it(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    load(service, 300)
    expect(alarm(desktop, "OVERLOAD")).to_contain_text("Load 300 kg is above 250 kg")
    expect(section(desktop).get_by_role("heading", name="Why")).to_have_text("Why 1 wrong")
    load(service, 0)
    over = section(desktop).get_by_role("list", name=re.compile("over, and not acknowledged"))
    expect(over.locator("ph-alarm")).to_contain_text("it is over; nobody has acknowledged it")
    expect(over.locator("ph-alarm")).to_have_attribute("data-state", "returned")

    alarm(desktop, "OVERLOAD").get_by_role("button", name="Acknowledge").click()

    expect(alarm(desktop, "OVERLOAD")).to_have_count(0)
    assert complaints.messages == []


def test_what_may_let_the_robot_go_on_needs_a_long_press(desktop: Page, service: Service) -> None:
    load(service, 300)
    held = alarm(desktop, "OVERLOAD").get_by_role("button", name="Acknowledge (hold)")
    held.click(delay=100)
    expect(alarm(desktop, "OVERLOAD")).to_have_attribute("data-state", "active")
    desktop.wait_for_timeout(2600)
    held.click(delay=1200)
    expect(alarm(desktop, "OVERLOAD")).to_contain_text("acknowledged")
    load(service, 0)
    expect(alarm(desktop, "OVERLOAD")).to_have_count(0)


def test_an_error_is_shelved_with_a_reason_and_announced_again(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    load(service, 300)
    shelve(desktop, "OVERLOAD", "the scale is being calibrated")

    folded = section(desktop).locator("summary").filter(has_text="1 not announced")
    folded.click()
    expect(alarm(desktop, "OVERLOAD")).to_contain_text(
        re.compile("shelved until .*: the scale is being calibrated")
    )
    expect(desktop.get_by_role("heading", level=1)).to_contain_text("ERROR")

    alarm(desktop, "OVERLOAD").get_by_role("button", name="Announce again").click()
    expect(folded).to_be_hidden()
    assert complaints.messages == []


def test_nothing_is_shelved_without_a_reason(desktop: Page, service: Service) -> None:
    load(service, 300)
    shelve(desktop, "OVERLOAD", "   ")
    expect(alarm(desktop, "OVERLOAD").get_by_role("alert").first).to_contain_text("Say why")
    assert error_of(service)["shelved_until_at"] is None


def test_an_error_that_comes_and_goes_says_what_would_calm_it(
    desktop: Page, service: Service
) -> None:
    load(service, *(300, 0) * 3)
    expect(alarm(desktop, "OVERLOAD").locator(".tags")).to_contain_text("chattering")
    alarm(desktop, "OVERLOAD").locator("summary").first.click()
    expect(alarm(desktop, "OVERLOAD")).to_contain_text(
        re.compile(r"it would be calm if it ended only after [\d.]+ s")
    )


def test_roots_come_first_with_what_follows_from_each(desktop: Page) -> None:
    desktop.evaluate(
        """async () => {
          const { errorGroups } = await import("/web/js/base/error_groups.js");
          window.groups = errorGroups;
        }"""
    )
    lidar, mapper = {"part": "lidar", "error": "SILENT"}, {"part": "mapper", "error": "LATE"}
    silent = {**told(**lidar), "root_cause": True, "roots": [lidar]}
    late = {**told(**mapper), "root_cause": False, "roots": [lidar]}
    hidden = {**told(part=None, error="HOT"), "suppressed": True}
    waits = {**told(part=None, error="SLOW"), "state": "pending"}
    found = desktop.evaluate(
        "errors => window.groups(errors)",
        {"a": late, "b": silent, "c": hidden, "d": waits},
    )
    assert [(each["error"]["error"], len(each["below"])) for each in found["on"]] == [("SILENT", 1)]
    assert [each["error"]["error"] for each in found["silenced"]] == ["HOT"]
    assert found["returned"] == []


def test_a_root_is_as_urgent_as_the_worst_that_follows_from_it(desktop: Page) -> None:
    desktop.evaluate(
        """async () => {
          const { errorGroups, worseBelow } = await import("/web/js/base/error_groups.js");
          window.names = (errors) => errorGroups(errors).on.map(({ error, below }) => [
            error.error,
            worseBelow(error, below)?.error ?? null,
          ]);
        }"""
    )
    drive = {"part": "drive", "error": "FAULT"}
    fault = {**told(**drive), "severity": "urgent"}
    lame = {
        **told(part="base", error="LAME"),
        "severity": "critical",
        "root_cause": False,
        "roots": [drive],
    }
    slow = {
        **told(part="lidar", error="SLOW"),
        "severity": "urgent",
        "since_at": "2026-01-01T00:00:00.000Z",
    }
    errors = {"a": slow, "b": fault, "c": lame}
    assert desktop.evaluate("errors => window.names(errors)", errors) == [
        ["FAULT", "LAME"],
        ["SLOW", None],
    ]


def test_the_list_fits_a_phone(phone: Page, service: Service) -> None:
    load(service, 300)
    expect(alarm(phone, "OVERLOAD")).to_be_visible()
    alarm(phone, "OVERLOAD").get_by_role("button", name="Shelve").click()
    expect(alarm(phone, "OVERLOAD").get_by_label("Reason")).to_be_focused()
    width = phone.evaluate("document.documentElement.scrollWidth")
    assert width <= 360
    small = section(phone).evaluate(
        """(section) => [...section.querySelectorAll("button, input, select, summary")]
             .filter((node) => node.checkVisibility() && node.getBoundingClientRect().height < 44)
             .map((node) => node.outerHTML)"""
    )
    assert small == []


def told(*, part: str | None, error: str) -> dict[str, Any]:
    """Return an error as frames have it."""
    return {
        "part": part,
        "error": error,
        "state": "active",
        "severity": "urgent",
        "suppressed": False,
        "shelved_until_at": None,
        "root_cause": True,
        "roots": [{"part": part, "error": error}],
        "since_at": "2026-05-04T12:00:00.000Z",
    }


def error_of(service: Service) -> Any:  # noqa: ANN401
    listed = service.request("GET", "/errors")["items"]
    return next(item for item in listed if item["error"] == "OVERLOAD")


# --- consequences --------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def rover(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    mobile = PROJECT / "examples" / "mobile_robot"
    arguments = (str(mobile / "model.yaml"), "--robot", str(mobile / "robot.yaml"))
    with serving(tmp_path_factory.mktemp("rover"), arguments) as service:
        yield service


def test_what_follows_from_an_error_is_folded_below_it_and_is_acknowledged_there(
    browser: Browser, rover: Service
) -> None:
    page = browser.new_page(viewport={"width": 1440, "height": 900})
    page.goto(rover.url)
    fault = {"active": True, "message": "overcurrent"}
    rover.request("POST", "/nodes/left_drive/errors/FAULT", fault)
    root = page.locator(".alarms > li > ph-alarm").filter(has_text="overcurrent")
    expect(root).to_contain_text("Critical: the task cannot go on (base.LAME)", timeout=10_000)
    expect(root).to_have_attribute("data-severity", "critical")
    expect(page).to_have_title("(1) ERROR · Pilothouse")
    below = root.locator("ph-alarm")
    expect(below).to_have_count(0)

    root.locator("summary").filter(has_text="1 follows from this").click()
    below.locator("summary").first.click()
    expect(below).to_contain_text("push the robot only with both drives without power")
    below.get_by_role("button", name="Acknowledge (hold)").click(delay=1200)
    expect(below.locator(".tags")).to_have_text("acknowledged")
    expect(page).to_have_title("ERROR · Pilothouse")

    root.get_by_role("button", name="Show left_drive").click()
    expect(page.locator("ph-part-panel h2")).to_have_text("left_drive")
    expect(page.get_by_role("list", name="Errors of this part")).to_contain_text("overcurrent")
    page.close()


def test_the_tab_counts_what_why_counts_and_not_what_follows_from_it(
    browser: Browser, rover: Service
) -> None:
    page = browser.new_page(viewport={"width": 360, "height": 640})
    page.goto(rover.url)
    rover.request("POST", "/nodes/left_drive/errors/FAULT", {"active": True, "message": "hot"})
    expect(section(page)).to_contain_text("1 follows from this", timeout=10_000)
    roots = page.locator("ul.alarms").first.locator("> li").count()
    expect(page.get_by_role("tab", name=f"Status, {roots} to attend to")).to_be_visible()
    page.close()
