"""The list of errors, as an operator reads it and uses it."""

import re
from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Locator, Page, expect

from tests.browser.station import Complaints, Service, free_port

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
    with (folder / "output").open("w+b") as output:
        service = Service(free_port(), output, ("--robot", str(robot)))
        try:
            service.start()
            yield service
        finally:
            service.kill()


@pytest.fixture
def service(running_service: Service) -> Service:
    load(running_service, 0)
    running_service.make_healthy()
    return running_service


def load(service: Service, *values_kg: float) -> None:
    for value in values_kg:
        service.request("POST", "/signals/load", {"value": value})


def section(page: Page) -> Locator:
    return page.locator("section.place-errors")


def alarm(page: Page, name: str) -> Locator:
    return section(page).locator("ph-alarm").filter(has_text=name)


def shelve(page: Page, name: str, reason: str) -> None:
    alarm(page, name).get_by_role("button", name="Shelve").first.click()
    alarm(page, name).get_by_label("Reason").fill(reason)
    alarm(page, name).get_by_label("For").select_option("30 min")
    alarm(page, name).locator("form").get_by_role("button", name="Shelve").click()


def test_a_robot_that_is_well_has_no_list(desktop: Page) -> None:
    expect(section(desktop)).to_be_hidden()


def test_an_error_that_is_over_stays_dimmed_until_somebody_has_seen_it(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    load(service, 300)
    expect(alarm(desktop, "OVERLOAD")).to_contain_text("load 300 kg is above 250 kg")
    expect(section(desktop).get_by_role("heading", name="Errors")).to_have_text("Errors (1)")
    load(service, 0)
    over = section(desktop).get_by_role("list", name=re.compile("over, and not acknowledged"))
    expect(over.locator("ph-alarm")).to_contain_text("it is over")
    expect(over.locator("ph-alarm")).to_have_attribute("data-state", "returned")

    alarm(desktop, "OVERLOAD").get_by_role("button", name="Acknowledge").click()

    expect(section(desktop)).to_be_hidden()
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
    expect(section(desktop)).to_be_hidden()


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
    expect(alarm(desktop, "OVERLOAD")).to_contain_text(re.compile("clear_for_s: .* would calm it"))


def test_what_follows_from_an_error_is_folded_below_it(desktop: Page) -> None:
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
