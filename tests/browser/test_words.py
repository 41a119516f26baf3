"""The page speaks as an operator does: no word of the interface is on it, in any state."""

import json
import re
from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Page

from tests.browser.states import SCREENS, STATES, running_robot
from tests.browser.station import Service

pytestmark = pytest.mark.browser

SEEN = """() => {
    const said = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        const parent = node.parentElement;
        if (parent.closest("script, style, noscript") || !parent.checkVisibility()) continue;
        if (node.data.trim()) said.push(node.data.trim());
    }
    for (const node of document.querySelectorAll("[title], [aria-label], [placeholder]"))
        for (const name of ["title", "aria-label", "placeholder"])
            if (node.checkVisibility()) said.push(node.getAttribute(name) ?? "");
    return [...new Set(said)];
}"""
OF_THE_INTERFACE = re.compile(
    r"__\w+__|[?&]\w+=|(?:^|\s)/\w*_\w+|\b(?:GET|PUT|POST|PATCH|DELETE) /"
)
NAME = re.compile(r"\w+")


def fields(service: Service) -> set[str]:
    """Return all names of the interface that are no plain words: fields, and values of choices."""
    found: set[str] = set()

    def look(node: Any) -> None:  # noqa: ANN401 - a schema
        if isinstance(node, list):
            for item in node:
                look(item)
        if isinstance(node, dict):
            found.update(node.get("properties") or ())
            found.update(item for item in node.get("enum") or () if isinstance(item, str))
            look(list(node.values()))

    look(service.request("GET", "/openapi.json"))
    return {name for name in found if "_" in name}


def own_names(service: Service) -> set[str]:
    """Return what the robot itself calls its signals, errors and parts."""
    signals = service.request("GET", "/signals")["items"]
    parts = [
        *service.request("GET", "/nodes")["items"],
        *service.request("GET", "/systems")["items"],
    ]
    raised = [str(fact) for signal in signals for fact in signal["settings"].values()]
    named = [*(signal["signal"] for signal in signals), *(part["name"] for part in parts), *raised]
    return {word for name in named for word in NAME.findall(name)}


def interface_words(page: Page, known: set[str]) -> list[str]:
    texts: list[str] = page.evaluate(SEEN)
    return [
        text
        for text in texts
        if OF_THE_INTERFACE.search(text) or known.intersection(NAME.findall(text))
    ]


def test_in_texts_the_default_mode_is_called_default_and_requests_keep_its_name(
    desktop: Page,
) -> None:
    sent = {
        "mode": "__DEFAULT__",
        "modes": {"__DEFAULT__": 1},
        "words": "arm is active.__DEFAULT__, __DEFAULT__ requested",
        "label": "active.__DEFAULT__",
        "part": "my__DEFAULT__part",
    }
    read = desktop.evaluate(
        """async (text) => {
            const { parsePlain } = await import("/web/js/base/plain_json.js");
            return parsePlain(text);
        }""",
        json.dumps(sent),
    )
    words = "arm is active.default, default requested"
    assert read == {**sent, "words": words, "label": "active.default"}


@pytest.mark.timeout(180)
@pytest.mark.parametrize("name", [name for name in STATES if name != "no_contact"])
def test_no_word_of_the_interface_is_on_the_page(browser: Browser, name: str) -> None:
    robot, act = STATES[name]
    width, height = SCREENS["desktop"]
    with running_robot(robot) as service:
        page = browser.new_page(viewport={"width": width, "height": height})
        page.goto(service.url)
        page.locator("ph-part-panel h2").wait_for()
        known = fields(service) - own_names(service)
        act(page, service)
        found = interface_words(page, known)
        page.close()
    assert found == []
