"""What a person does to drive the robot on the page: the strip, the sheet, the map."""

from typing import TYPE_CHECKING, Any

from playwright.sync_api import expect

from tests.browser.places import sentence

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

    from tests.browser.station import Service


def strip(page: "Page") -> "Locator":
    return page.locator("ph-task-strip")


def sheet(page: "Page") -> "Locator":
    return page.get_by_role("dialog", name="New task")


def words(page: "Page") -> "Locator":
    """What the map tells those who do not see it."""
    return page.locator("#map-words")


def canvas(page: "Page") -> "Locator":
    return page.locator("ph-map canvas")


def button(page: "Page", name: str) -> "Locator":
    return page.get_by_role("button", name=name)


def open_sheet(page: "Page") -> None:
    button(page, "New task").click()
    expect(page.get_by_label("Choose a CSV")).to_be_attached()
    expect(page.get_by_label("Controller")).to_contain_text("Pure Pursuit")


def choose(page: "Page", content: bytes, name: str = "field.csv") -> None:
    if not sheet(page).is_visible():
        open_sheet(page)
    file: Any = {"name": name, "mimeType": "text/csv", "buffer": content}
    page.get_by_label("Choose a CSV").set_input_files(file)
    # A process of its own reads the file, and the first one has to start.
    expect(sheet(page)).not_to_contain_text("Checking", timeout=20_000)


def start(page: "Page", service: "Service", length_m: int) -> None:
    choose(page, service.track_ahead(length_m))
    page.get_by_role("button", name="Start", exact=True).click()
    expect_running(page)


def expect_running(page: "Page") -> None:
    # A process of its own reads the file, and the first one has to start.
    expect(sentence(page)).to_contain_text("RUNNING: task ", timeout=20_000)


def hold(button: "Locator", page: "Page") -> None:
    button.hover()
    page.mouse.down()
    page.wait_for_timeout(1700)
    page.mouse.up()
