"""In each state the page speaks as an operator does, and who hears it or has no mouse finds all.

Each state is brought about once, and then judged.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, Page

from tests.browser.interface_words import fields, interface_words, own_names
from tests.browser.states import SCHEMES, SCREENS, STATES, running_robot

pytestmark = [pytest.mark.browser, pytest.mark.timeout(180)]

SETTLE_MS = 600
"""Colours change over a moment, and are judged after it."""


@dataclass
class Shown:
    """A page in a state."""

    page: Page
    fields: set[str]
    """Names of the interface that the robot has no use for itself."""


@pytest.fixture(scope="module", params=STATES)
def shown(browser: Browser, request: pytest.FixtureRequest) -> Iterator[Shown]:
    robot, act = STATES[request.param]
    width, height = SCREENS["desktop"]
    context = browser.new_context(
        viewport={"width": width, "height": height},
        has_touch=True,
        forced_colors="active" if request.param == "forced_colors" else "none",
    )
    with running_robot(robot) as service:
        page = context.new_page()
        page.goto(service.url)
        page.locator("ph-part-panel h2").wait_for(state="attached")
        known = fields(service) - own_names(service)
        act(page, service)
        yield Shown(page, known)
    context.close()


def test_no_word_of_the_interface_is_on_the_page(shown: Shown) -> None:
    assert interface_words(shown.page, shown.fields) == []


def test_axe_finds_no_violation(shown: Shown) -> None:
    found = [
        violation
        for screen in SCREENS
        for scheme in SCHEMES
        for violation in violations(shown.page, screen, scheme)
    ]
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
