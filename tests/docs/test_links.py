"""Every relative link in the pages of the root, docs and examples leads somewhere."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.shared import PROJECT

# The template of a decision names files that are not there.
PAGES = [
    *sorted(PROJECT.glob("*.md")),
    *(page for page in sorted((PROJECT / "docs").rglob("*.md")) if page.name != "template.md"),
    *sorted((PROJECT / "examples").rglob("*.md")),
]
FENCED = re.compile(r"^ *```.*?^ *```$", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"`[^`\n]*`")
LINK = re.compile(r"\]\(([^)\s]+)\)|^\[[^\]]+\]: (\S+)$", re.MULTILINE)
HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)


def links(page: Path) -> Iterator[str]:
    """Yield where a page points to, without what is outside of the checkout."""
    text = CODE.sub("", FENCED.sub("", page.read_text(encoding="utf-8")))
    for inline, named in LINK.findall(text):
        link = inline or named
        if not re.match(r"[a-z]+:", link):
            yield link


def anchors(page: Path) -> set[str]:
    """Return the anchors that the headings of a page get."""
    headings = HEADING.findall(FENCED.sub("", page.read_text(encoding="utf-8")))
    return {anchor(heading) for heading in headings}


def anchor(heading: str) -> str:
    """Return the anchor of a heading: small letters, no marks, hyphens for spaces."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(PROJECT)))
def test_every_link_of_a_page_leads_to_a_file_or_a_heading(page: Path) -> None:
    dead = []
    for link in links(page):
        name, _, wanted = link.partition("#")
        target = (page.parent / name).resolve() if name else page
        if not target.exists() or (wanted and wanted not in anchors(target)):
            dead.append(link)

    assert not dead, "\n".join(dead)


def test_every_page_is_reached_from_the_map() -> None:
    start = PROJECT / "docs" / "README.md"
    seen, waiting = {start}, [start]
    while waiting:
        page = waiting.pop()
        for link in links(page):
            target = (page.parent / link.partition("#")[0]).resolve()
            if target.is_dir():
                continue
            if target.suffix == ".md" and target.is_file() and target not in seen:
                seen.add(target)
                waiting.append(target)
    decisions = PROJECT / "docs" / "decisions"

    missing = [page for page in PAGES if page not in seen and page.parent != decisions]

    assert missing in ([], [PROJECT / "README.md"]), "\n".join(map(str, missing))


def test_the_anchor_of_a_heading_is_that_of_the_usual_viewers() -> None:
    assert anchor("An error that waits for a person") == "an-error-that-waits-for-a-person"
    assert anchor("Warnings of `/healthz`") == "warnings-of-healthz"
    assert anchor("2. The four steps") == "2-the-four-steps"
