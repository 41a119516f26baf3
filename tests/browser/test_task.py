"""What an operator does with a task: the strip and the sheet, over the real service."""

import re

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Page, expect

from tests.browser.driving import (
    button,
    canvas,
    choose,
    expect_running,
    hold,
    open_sheet,
    sheet,
    start,
    strip,
    words,
)
from tests.browser.places import sentence
from tests.browser.station import Complaints, Service

pytestmark = pytest.mark.browser


def test_a_track_is_seen_before_it_is_driven_and_drives_pauses_and_ends_as_asked(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    expect(strip(desktop)).to_contain_text("NO TASK")
    choose(desktop, service.track_ahead(60))
    expect(sheet(desktop)).to_contain_text("field.csv")
    expect(sheet(desktop)).to_contain_text("60 m, 121 waypoints, 0.50 m apart")
    expect(sentence(desktop)).to_have_text("IDLE: no task")

    began = service.pose()
    desktop.get_by_role("button", name="Start", exact=True).click()
    expect(sentence(desktop)).to_have_text(
        re.compile(r"^RUNNING: task t\d+ [1-9]\d? %, waypoint \d+ of 121$"), timeout=20_000
    )
    expect(sheet(desktop)).to_be_hidden()
    assert service.pose() != began
    expect(words(desktop)).to_contain_text(re.compile(r"Task t\d+, [1-9]\d? % done"))
    expect(strip(desktop)).to_contain_text(re.compile(r"RUNNINGtask t\d+, [1-9]\d? %"))
    expect(strip(desktop)).to_contain_text(re.compile(r"Waypoint \d+ of 121"))
    expect(strip(desktop)).to_contain_text(re.compile(r"ETA \d\d:\d\d[1-6]0 s"))
    expect(strip(desktop)).to_contain_text(re.compile(r"Off path0\.0\d m"))
    expect(strip(desktop)).to_contain_text(re.compile(r"Speed[1-9]\.\d m/s"))

    button(desktop, "Pause").click()
    expect(sentence(desktop)).to_have_text(
        re.compile(r"^HELD: task t\d+ at \d+ %, held by operator \(paused on the page\)$"),
        timeout=15_000,
    )
    expect(strip(desktop)).to_contain_text("HELD")
    expect(strip(desktop)).to_contain_text("By operator: paused on the page")
    hold(button(desktop, "Resume (hold)"), desktop)
    expect(sentence(desktop)).to_contain_text("RUNNING")

    hold(button(desktop, "Cancel (hold)"), desktop)
    expect(strip(desktop)).to_contain_text(re.compile(r"CANCELEDtask t\d+At \d\d:"))
    expect(sentence(desktop)).to_have_text("IDLE: no task")
    assert complaints.messages == []


def test_a_short_press_of_cancel_cancels_nothing_and_says_so(
    desktop: Page, service: Service
) -> None:
    start(desktop, service, 60)
    cancel = button(desktop, "Cancel (hold)")
    cancel.click()
    expect(button(desktop, "Keep it pressed for 1 s")).to_be_visible()
    expect(cancel).to_be_visible()
    expect_running(desktop)


def test_how_a_task_ended_is_told_also_after_the_page_is_opened_anew(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    start(desktop, service, 6)
    expect(strip(desktop)).to_contain_text("SUCCEEDED", timeout=20_000)
    ended = re.compile(r"At \d\d:\d\d:\d\d[56]\.\d m of 6\.0 m in \d")
    expect(strip(desktop)).to_contain_text(ended)
    told = strip(desktop).get_by_role("status")
    expect(told).to_have_text(re.compile(r"Task t\d+ succeeded at \d\d:\d\d:\d\d \([56]"))
    desktop.reload()
    expect(strip(desktop)).to_contain_text(ended)
    assert complaints.messages == []


def test_the_example_drives_at_one_click_in_the_sheet(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    # It begins where the vehicle is after a start.
    service.kill()
    service.start()
    desktop.reload()
    complaints.messages.clear()
    button(desktop, "New task").click()
    button(desktop, "Drive the example loop").click()
    expect_running(desktop)
    expect(sheet(desktop)).to_be_hidden()
    button(desktop, "New task").click()
    expect(button(desktop, "Drive the example loop")).to_be_hidden()
    assert complaints.messages == []


def test_the_sheet_opens_and_closes_by_keys_and_leaves_all_else_within_reach(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    button(desktop, "New task").focus()
    desktop.keyboard.press("Enter")
    expect(sheet(desktop)).to_be_focused()
    expect(button(desktop, "New task")).to_have_attribute("aria-expanded", "true")
    expect(desktop.locator("button.stop")).to_be_in_viewport(ratio=1)
    choose(desktop, service.track_ahead(30))
    expect(sheet(desktop)).to_contain_text("30 m, 61 waypoints")
    desktop.get_by_role("button", name="Start", exact=True).focus()
    desktop.keyboard.press("Escape")
    expect(sheet(desktop)).to_be_hidden()
    expect(button(desktop, "New task")).to_be_focused()
    # What was not started is forgotten.
    open_sheet(desktop)
    expect(sheet(desktop)).not_to_contain_text("field.csv")
    assert complaints.messages == []


def test_another_task_replaces_the_one_that_runs_only_when_it_is_said(
    desktop: Page, service: Service
) -> None:
    start(desktop, service, 60)
    [before] = re.findall(r"t\d+", strip(desktop).locator(".task-name").inner_text())
    choose(desktop, service.track_ahead(40))
    expect(sheet(desktop)).to_contain_text("40 m, 81 waypoints")
    button(desktop, f"Replace task {before}").click()
    expect(strip(desktop)).to_contain_text("of 81", timeout=20_000)
    expect(strip(desktop)).not_to_contain_text(f"task {before},")


def test_a_track_that_begins_far_away_can_be_begun_where_it_passes_the_vehicle(
    desktop: Page, service: Service
) -> None:
    pose = desktop.request.get(f"{service.url}/vehicle").json()["pose"]
    x, y = pose["x_m"], pose["y_m"]
    passing = "".join(f"{x + step},{y},0\n" for step in range(-20, 21))
    choose(desktop, passing.encode(), "passing.csv")
    button(desktop, "Start").click()
    expect(desktop.locator("ph-task-form").get_by_role("alert")).to_contain_text("begins 20.0 m")
    button(desktop, "Start at waypoint 21").click()

    expect_running(desktop)


def test_a_refused_file_shows_the_line_and_starts_nothing(desktop: Page, service: Service) -> None:
    choose(desktop, b"0,0,0\n1,0,0\n2,zwei<b>,0\n3,0,0\n", "bad.csv")
    alert = desktop.locator("ph-task-form").get_by_role("alert")
    expect(alert).to_contain_text("Rejected: ")
    expect(alert).to_contain_text("Line 3")
    expect(alert.locator("code")).to_have_text("2,zwei<b>,0")
    expect(button(desktop, "Start")).to_be_hidden()
    button(desktop, "Discard").click()
    expect(alert).to_be_hidden()


def test_an_empty_file_is_refused_in_words(desktop: Page) -> None:
    choose(desktop, b"", "empty.csv")
    expect(desktop.locator("ph-task-form").get_by_role("alert")).to_contain_text("Rejected: ")


def test_a_preview_tells_how_the_columns_were_read(desktop: Page, service: Service) -> None:
    rows = service.track_ahead(30).decode().replace(",", "; ").replace("\n", "\r")
    choose(desktop, ("\ufeffX [m]; Y [m]; yaw\r" + rows).encode("utf-16-le"))
    expect(sheet(desktop)).to_contain_text(
        "Semicolon-separated, named in line 1: x from X [m] (column 1), y from Y [m] (column 2),"
        " heading from yaw (column 3), radians counter-clockwise from east"
    )
    expect(desktop.get_by_label("Headings in")).to_be_hidden()


def test_a_column_that_is_no_heading_is_asked_about_and_can_be_left_out(
    desktop: Page, service: Service
) -> None:
    open_sheet(desktop)
    heading, columns = desktop.get_by_label("Headings in"), desktop.get_by_label("Columns")
    expect(heading).to_be_hidden()
    choose(desktop, service.track_ahead(30, scans=True))
    expect(sheet(desktop)).to_contain_text("the third column fits the path as a heading in no unit")
    expect(heading).to_be_visible()
    button(desktop, "Start").click()
    expect(desktop.locator("ph-task-form").get_by_role("alert")).to_contain_text("no unit")
    columns.fill("x,y")
    columns.blur()
    expect(sheet(desktop)).to_contain_text("headings from the path")
    expect(sheet(desktop)).not_to_contain_text("in no unit")
    expect(desktop.get_by_role("button", name="Start", exact=True)).to_be_enabled()


def test_a_file_dropped_on_the_map_is_previewed(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    transfer = desktop.evaluate_handle(
        """(text) => {
            const transfer = new DataTransfer();
            transfer.items.add(new File([text], "dropped.csv", { type: "text/csv" }));
            return transfer;
        }""",
        service.track_ahead(20).decode(),
    )
    canvas(desktop).dispatch_event("dragover", {"dataTransfer": transfer})
    canvas(desktop).dispatch_event("drop", {"dataTransfer": transfer})
    expect(sheet(desktop)).to_contain_text("dropped.csv")
    expect(sheet(desktop)).to_contain_text("20 m, 41 waypoints")
    expect(sentence(desktop)).to_have_text("IDLE: no task")
    assert complaints.messages == []


def test_an_error_holds_the_task_and_the_strip_says_what_holds_it(
    desktop: Page, service: Service, complaints: Complaints
) -> None:
    start(desktop, service, 60)
    service.request("PATCH", "/mock/battery_level", {"value": 0.1})
    expect(sentence(desktop)).to_have_text(
        re.compile(r"^ERROR: battery 10 % is below 50 %, task t\d+ is paused$")
    )
    way = strip(desktop).locator(".task-way")
    expect(way).to_contain_text("By error")
    service.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    expect(way).to_contain_text(", +1 more")
    expect(way).to_have_attribute("title", re.compile("gate: the gate is shut"))
    service.request("PATCH", "/mock/battery_level", {"value": 0.9})
    expect(way).to_have_text("By gate: the gate is shut")
    # What another one holds is not released by whoever looks at the task.
    expect(button(desktop, "Resume (hold)")).to_be_hidden()
    service.request("DELETE", "/holds/gate")
    expect_running(desktop)
    assert complaints.messages == []


def test_on_a_phone_a_driven_task_leaves_everything_reachable(
    phone: Page, service: Service, complaints: Complaints
) -> None:
    expect(canvas(phone)).to_be_hidden()
    choose(phone, service.track_ahead(60))
    # The path is seen before it is driven, so the sheet comes with the map.
    expect(phone.get_by_role("tab", name="Map")).to_have_attribute("aria-selected", "true")
    expect(sheet(phone)).to_contain_text("60 m, 121 waypoints")
    box = canvas(phone).bounding_box()
    assert box is not None
    assert box["height"] >= 130
    assert phone.evaluate("document.documentElement.scrollWidth") == 360
    phone.get_by_role("button", name="Start", exact=True).click()
    expect_running(phone)
    assert phone.evaluate("document.documentElement.scrollWidth") == 360
    box = canvas(phone).bounding_box()
    assert box is not None
    assert box["height"] >= 260
    phone.get_by_role("tab", name="Status").click()
    expect(canvas(phone)).to_be_hidden()
    pause = button(phone, "Pause")
    box = pause.bounding_box()
    assert box is not None
    assert box["height"] >= 56
    pause.click()
    expect(button(phone, "Resume")).to_be_visible()
    expect(phone.locator("button.stop")).to_be_in_viewport(ratio=1)
    assert complaints.messages == []
