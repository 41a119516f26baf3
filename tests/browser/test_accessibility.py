"""Whoever uses a screen reader or a keyboard finds what the page shows: axe-core, in each state."""

from typing import Literal

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, Page

from tests.browser.states import SCHEMES, SCREENS, STATES, running_robot

pytestmark = pytest.mark.browser

SETTLE_MS = 600
"""Colours change over a moment, and are judged after it."""


@pytest.mark.timeout(180)
@pytest.mark.parametrize("name", STATES)
def test_axe_finds_no_violation(browser: Browser, name: str) -> None:
    robot, act = STATES[name]
    width, height = SCREENS["desktop"]
    context = browser.new_context(
        viewport={"width": width, "height": height},
        has_touch=True,
        forced_colors="active" if name == "forced_colors" else "none",
    )
    with running_robot(robot) as service:
        page = context.new_page()
        page.goto(service.url)
        page.locator("ph-part-panel h2").wait_for(state="attached")
        act(page, service)
        found = [
            violation
            for screen in SCREENS
            for scheme in SCHEMES
            for violation in violations(page, screen, scheme)
        ]
    context.close()
    assert found == []


def violations(page: Page, screen: str, scheme: Literal["light", "dark"]) -> list[str]:
    """Return what axe-core finds on the page as it is, with the first elements that have it."""
    width, height = SCREENS[screen]
    page.set_viewport_size({"width": width, "height": height})
    page.emulate_media(color_scheme=scheme)
    page.wait_for_timeout(SETTLE_MS)
    return [
        f"{screen}, {scheme}: {item['id']}: {[node['html'][:160] for node in item['nodes'][:3]]}"
        for item in Axe().run(page).response["violations"]
    ]
