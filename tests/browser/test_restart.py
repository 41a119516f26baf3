"""After a restart nothing moves, and the page says what waits for whom."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Locator, Page, expect

from tests.browser.places import sentence
from tests.browser.station import Service, serving

pytestmark = pytest.mark.browser


@pytest.fixture
def kept(tmp_path: Path) -> Iterator[Service]:
    """Return a robot with a start task that keeps what happens."""
    (tmp_path / "track.csv").write_text("".join(f"{2 * n},0,0\n" for n in range(60)))
    robot = tmp_path / "robot.json"
    robot.write_text(json.dumps({"start_task": {"file": "track.csv"}}))
    with serving(tmp_path, ("--robot", str(robot)), keeps=True) as service:
        yield service


def opened(browser: Browser, service: Service, width: int, height: int) -> Page:
    page = browser.new_page(viewport={"width": width, "height": height})
    page.goto(service.url)
    return page


def restart(page: Page, service: Service) -> None:
    service.kill()
    expect(sentence(page)).to_contain_text("No contact")
    service.start()
    page.get_by_text("Try now").dispatch_event("click")


def press(button: Locator, page: Page) -> None:
    button.hover()
    page.mouse.down()
    page.wait_for_timeout(1300)
    page.mouse.up()


@pytest.mark.parametrize("name", ["Resume (hold)", "Release restart (hold)"])
def test_a_task_over_a_restart_waits_for_a_long_press_and_goes_on(
    browser: Browser, kept: Service, name: str
) -> None:
    page = opened(browser, kept, 1280, 800)
    expect(sentence(page)).to_contain_text("RUNNING: task t1")
    restart(page, kept)
    expect(sentence(page)).to_contain_text("HELD: task t1")
    notice = page.locator("ph-notices .notice")
    expect(notice).to_contain_text(
        re.compile(
            r"^Started again at [\d:]+; it remembers task t1.*; the task is held by restart\."
        )
    )
    hold = page.get_by_role("list", name="Holds").get_by_role("listitem")
    expect(hold).to_contain_text("the service was restarted")
    expect(hold).to_have_attribute("title", re.compile(r"^restart, .*for \d+ s, by Pilothouse"))
    expect(page.get_by_role("button", name="Pause")).to_be_hidden()

    press(page.get_by_role("button", name=name), page)

    expect(sentence(page)).to_contain_text("RUNNING: task t1")
    expect(page.get_by_role("button", name="Pause")).to_be_visible()
    expect(notice).not_to_contain_text("held by restart")
    notice.get_by_role("button", name="Dismiss").click()
    expect(notice).to_be_hidden()
    page.close()


def test_the_start_task_waits_after_a_restart_and_says_who_asked_for_it(
    browser: Browser, kept: Service
) -> None:
    page = opened(browser, kept, 360, 640)
    expect(sentence(page)).to_contain_text("RUNNING: task t1")
    kept.request("DELETE", "/tasks/current")
    restart(page, kept)
    expect(sentence(page)).to_contain_text("HELD: task")
    hold = page.get_by_role("list", name="Holds").get_by_role("listitem")
    expect(hold).to_contain_text(
        "start_task: the service was restarted: release this hold to drive the start task"
    )
    expect(hold).to_contain_text(re.compile(r"for \d+ s, by robot file"))
    assert page.evaluate("document.documentElement.scrollWidth") == 360

    press(page.get_by_role("button", name="Release start_task (hold)"), page)

    expect(sentence(page)).to_contain_text("RUNNING: task")
    page.close()
