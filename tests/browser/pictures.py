"""The pictures of the documents, each of a real run.

Run `make pictures`, or `python -m tests.browser.pictures [NAME ...]`.
"""

import argparse
from pathlib import Path
from typing import Literal

from PIL import Image
from playwright.sync_api import Browser, Page, sync_playwright

from tests.browser.states import SCREENS, STATES, Robot, open_form, post, running_robot
from tests.browser.station import CHROMIUM, CHROMIUM_ARGUMENTS, Service
from tests.support.shared import PROJECT

FOLDER = PROJECT / "docs" / "pictures"
SETTLE_MS = 900
ON_THE_LOOP_MS = 100_000
LOOP = "loop"
"""No state to be looked at: it takes as long as a good part of a lap."""

Scheme = Literal["light", "dark"]
PICTURES: dict[str, tuple[str, str, Scheme]] = {
    "desktop": (LOOP, "desktop", "light"),
    "dark": ("reactions", "desktop", "dark"),
    "error": ("guarded", "desktop", "light"),
    "why": ("reacting", "desktop", "light"),
    "timeline": ("timeline_pinned", "desktop", "light"),
    "what-if": ("what_if", "desktop", "light"),
    "no-contact": ("no_contact", "desktop", "light"),
    "parts-300": ("parts_300", "desktop", "light"),
    "phone": ("running", "phone", "light"),
    "phone-error": ("reacting", "phone", "light"),
}


def drive_the_loop(page: Page, service: Service) -> None:
    post(service, "/systems/actuation/mode?wait=15", {"mode": "MODERATE"})
    open_form(page)
    page.get_by_role("button", name="Drive the example loop").click()
    page.wait_for_timeout(ON_THE_LOOP_MS)


def take(browser: Browser, name: str) -> None:
    """Bring the state about on a robot of its own, and take its picture."""
    state, screen, scheme = PICTURES[name]
    kind: Robot
    kind, act = ("example", drive_the_loop) if state == LOOP else STATES[state]
    width, height = SCREENS[screen]
    with running_robot(kind) as service:
        page = browser.new_page(
            viewport={"width": width, "height": height},
            has_touch=screen == "phone",
            color_scheme=scheme,
        )
        page.goto(service.url)
        page.locator("ph-part-panel h2").wait_for(state="attached")
        act(page, service)
        page.wait_for_timeout(SETTLE_MS)
        file = FOLDER / f"{name}.png"
        page.screenshot(path=file)
        page.close()
    shrink(file)


def shrink(file: Path) -> None:
    """Let a picture have 256 colours, which such a page is well shown in: a third of the bytes."""
    with Image.open(file) as picture:
        small = picture.convert("RGB").quantize(256, dither=Image.Dither.NONE)
    small.save(file, optimize=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(PICTURES))
    arguments = parser.parse_args()
    FOLDER.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright:
        chromium = playwright.chromium
        browser = chromium.launch(executable_path=str(CHROMIUM), args=CHROMIUM_ARGUMENTS)
        for name in arguments.names or PICTURES:
            take(browser, name)


if __name__ == "__main__":
    main()
