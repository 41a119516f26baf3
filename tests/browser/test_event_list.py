"""The list of events, also those of earlier runs of the service."""

import re

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Locator, Page, expect

from tests.browser.earlier_runs import LAST, tell_earlier_runs
from tests.browser.station import Complaints

pytestmark = pytest.mark.browser


def events(page: Page) -> Locator:
    return page.get_by_role("list", name="Recent events")


def open_log(page: Page) -> None:
    page.get_by_role("tab", name="Log").click()


def earlier(page: Page) -> Locator:
    return page.get_by_role("button", name=re.compile("^Earlier"))


def words(page: Page) -> list[str]:
    return events(page).locator(".event-words").all_inner_texts()


def open_log_of_earlier_runs(page: Page) -> None:
    """Open the log, and go back to the first of the earlier runs."""
    tell_earlier_runs(page)
    open_log(page)
    expect(events(page)).to_contain_text(f"thing {LAST} happened")
    for _ in range(3):
        count = events(page).locator("li").count()
        earlier(page).click()
        expect(events(page).locator("li")).not_to_have_count(count)


def test_earlier_events_are_loaded_over_restarts_up_to_the_first(
    desktop: Page, complaints: Complaints
) -> None:
    asked = tell_earlier_runs(desktop)
    open_log(desktop)
    desktop.get_by_role("switch", name="Show details").check()
    expect(events(desktop)).to_contain_text(f"thing {LAST} happened")

    while earlier(desktop).is_visible():
        count = events(desktop).locator("li").count()
        earlier(desktop).click()
        expect(events(desktop).locator("li")).not_to_have_count(count)

    told = words(desktop)
    assert told[0] == f"thing {LAST} happened"
    assert told[-1] == "thing 1 happened"
    assert len(told) == len(set(told) - {"restored after a restart: 1 hold"}) + 2 == LAST - 20
    of_the_log = [query for query in asked if not query.startswith(("kind=", "after="))]
    assert len([query for query in of_the_log if not query.endswith("limit=1")]) <= 4
    assert complaints.messages == []


def test_events_of_another_day_have_their_day_above_them(desktop: Page) -> None:
    open_log_of_earlier_runs(desktop)
    days = events(desktop).locator("li.day")
    expect(days).to_have_text(["2026-03-03", "2026-03-02", "2026-03-01"])
    below = days.last.evaluate("(day) => day.nextElementSibling.textContent")
    assert "thing 299 happened" in below


def test_a_line_tells_of_each_restart_and_of_what_may_be_missing(desktop: Page) -> None:
    open_log_of_earlier_runs(desktop)

    restarts = events(desktop).locator(".restart")
    expect(restarts.nth(0)).to_have_text(re.compile(r"^Restarted at \d\d:\d\d:01 on 2026-03-03$"))
    expect(restarts.nth(1)).to_have_text(
        re.compile(
            r"^Restarted at \d\d:\d\d:21 on 2026-03-02; the last events before may be missing$"
        )
    )
    # Newest first: the line is below the first event of the new run.
    above = restarts.nth(0).locator("xpath=preceding-sibling::li[1]")
    expect(above).to_contain_text("restored after a restart")


def test_who_scrolls_to_the_end_gets_more_and_keeps_the_place(phone: Page) -> None:
    tell_earlier_runs(phone)
    open_log(phone)
    expect(events(phone)).to_contain_text(f"thing {LAST} happened")
    before = events(phone).locator("li .event-words").last.inner_text()

    phone.locator("ph-event-list").scroll_into_view_if_needed()
    events(phone).evaluate("list => list.scrollTo(0, list.scrollHeight)")

    expect(events(phone).locator("li .event-words").last).not_to_have_text(before)
    read = events(phone).locator("li").filter(has_text=before)
    expect(read).to_be_in_viewport()
    assert phone.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_why_earlier_events_cannot_be_read_is_told(desktop: Page) -> None:
    tell_earlier_runs(desktop)
    open_log(desktop)
    expect(events(desktop)).to_contain_text(f"thing {LAST} happened")
    detail = "earlier events cannot be read: disk I/O error"
    problem = f'{{"status": 503, "code": "STORAGE_DEGRADED", "detail": "{detail}"}}'
    desktop.route("**/events?before=*", lambda route: route.fulfill(status=503, body=problem))

    earlier(desktop).click()
    earlier(desktop).click()

    expect(desktop.locator("ph-event-list")).to_contain_text(detail)
    expect(earlier(desktop)).to_be_visible()


def test_a_service_that_has_told_everything_offers_nothing_earlier(desktop: Page) -> None:
    open_log(desktop)
    expect(events(desktop).locator("li")).not_to_have_count(0)
    while earlier(desktop).is_visible():
        earlier(desktop).click()
        # With the last ones, the button goes.
        expect(desktop.locator("ph-event-list [data-sending]")).to_have_count(0)

    expect(earlier(desktop)).to_be_hidden()
