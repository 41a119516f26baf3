"""Words of the interface, which are not those of an operator, among what a page says."""

import re
from typing import Any

from playwright.sync_api import Page

from tests.browser.station import Service

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
