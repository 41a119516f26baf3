"""Where a person looks for what matters most on the page."""

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page


def sentence(page: "Page") -> "Locator":
    """Return the state of the robot in words."""
    return page.get_by_role("heading", level=1)


def header(page: "Page") -> "Locator":
    return page.locator("body > header")


def stop(page: "Page") -> "Locator":
    return page.get_by_role("button", name=re.compile("^STOP"))
