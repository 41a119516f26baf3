"""A recording in the monitor page, in a real browser and over the real server."""

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Page, expect

from tests.browser.station import Complaints
from tests.support.process import ServiceProcess, replay_page
from tests.support.stored_robot import held_on_its_way, store

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.browser

SIZES = {"desktop": (1280, 800), "phone": (360, 640)}


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServiceProcess]:
    folder = tmp_path_factory.mktemp("data") / "gem_e2"
    store(folder, held_on_its_way(), checkpoints=(20,))
    with replay_page(folder, "--speed", "0.1") as process:
        yield process


# The recording first: while playwright runs, no coroutine can write one.
@pytest.fixture(params=SIZES)
def page(
    recording: ServiceProcess,
    browser: "Browser",
    complaints: Complaints,
    request: pytest.FixtureRequest,
) -> Iterator[Page]:
    width, height = SIZES[request.param]
    context = browser.new_context(viewport={"width": width, "height": height})
    page = context.new_page()
    complaints.watch(page)
    page.goto(recording.url)
    expect(page.get_by_text("REPLAY of gem_e2")).to_be_visible()
    yield page
    context.close()


def test_it_is_framed_as_a_recording_and_stop_says_that_no_robot_hears_it(
    page: Page, complaints: Complaints
) -> None:
    stop = page.get_by_role("button", name=re.compile("^STOP"))

    expect(stop).to_be_disabled()
    expect(stop).to_have_accessible_description("Recording: no robot hears STOP")
    said = page.locator("#stop-note")
    assert said.evaluate("(note) => note.scrollWidth - note.clientWidth") <= 0
    expect(page.get_by_text("Key: Shift+Esc")).to_be_hidden()
    expect(page).to_have_title("REPLAY · Pilothouse")
    frame = page.evaluate("getComputedStyle(document.body, '::after').borderTopWidth")
    assert frame == "4px"
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert complaints.messages == []


def test_pause_speed_and_time_are_set_on_the_page(page: Page, complaints: Complaints) -> None:
    bar = page.locator("ph-replay-bar")
    bar.get_by_role("button", name="Pause").click()
    expect(page.locator(".replayed")).to_contain_text(", paused")

    # The last but a few: the task was held by then.
    bar.get_by_label("Time").fill("700")
    expect(page.locator(".replayed")).to_contain_text("00:00:02")
    expect(page.get_by_text("gate").locator("visible=true").first).to_be_visible()

    bar.get_by_label("Speed").select_option("10")
    expect(page.locator(".replayed")).to_contain_text(re.compile(r"\b10, paused"))
    bar.get_by_label("Time").fill("0")
    expect(page.locator(".replayed")).to_contain_text("00:00:00")
    bar.get_by_label("Speed").select_option("0.1")
    bar.get_by_role("button", name="Play").click()
    expect(page.locator(".replayed")).not_to_contain_text("paused")
    assert complaints.messages == []


def test_what_would_move_a_robot_is_rejected_in_words(page: Page) -> None:
    answer = page.request.put(f"{page.url}emergency_stop", data={"engaged": True})

    assert answer.status == 409
    assert "this is a recording" in answer.json()["detail"]
