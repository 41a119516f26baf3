"""The page as it is served: its frame, and all files that belong to one version of it.

It is put together once, from the files of the package `web`, so there is no step of building.
"""

import hashlib
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import PurePosixPath
from typing import TypeAlias

from api.http.page.ahead import kept
from api.http.page.bundles import make_bundles, pack
from api.http.page.minifier import minified
from api.http.page.module_graph import Modules
from api.http.page.module_text import PageError, squeeze
from api.http.page.page_file import MEDIA_TYPES, PageFile

Shorten: TypeAlias = Callable[[Mapping[str, str]], Mapping[str, str]]

_INDEX = "index.html"
_STYLE = re.compile(r'<link rel="stylesheet" href="/web/(style/\w+\.css)">\n')
_SCRIPT = re.compile(r'<script type="module" src="/web/(js/\w+\.js)"></script>\n')
_ICON = re.compile(r'href="/web/(\w+\.svg)"')
_IMPORT_OF_STYLE = re.compile(r"@import|url\(")


@dataclass(frozen=True, slots=True)
class AssembledPage:
    """One version of the page."""

    version: str
    """Of everything that a browser loads for it."""
    head: str
    """The frame up to where the first frame of the robot stands."""
    foot: str
    files: Mapping[str, PageFile]
    """By name, below `/web/v/VERSION/`."""
    first: tuple[str, ...]
    """Names of the styles and scripts that the first use needs."""


def sources() -> Mapping[str, str]:
    """Return the texts of the files as they are written, by path below `web/`."""
    return {path: entry.read_text(encoding="utf-8") for path, entry in written_files().items()}


@cache
def written_files() -> Mapping[str, Traversable]:
    """Return the files as they are written, by path below `web/`.

    Where they are, and not what is in them: nearly all requests are for the bundles.
    """
    return dict(_find_all(files("web"), ""))


@cache
def assembled_page() -> AssembledPage:
    """Return the page of this installation; the first time, this takes half a second.

    Raises:
        PageError: A file cannot be bundled.
    """
    return assemble(sources(), lambda bundles: kept(bundles) or minified(bundles))


def assemble(texts: Mapping[str, str], shorten: Shorten = lambda texts: texts) -> AssembledPage:
    """Put a page together.

    Args:
        texts: Its files, by path below `web/`; among them `index.html`.
        shorten: Says scripts and style sheets in fewer characters.

    Raises:
        PageError: A file cannot be bundled.
    """
    index = texts[_INDEX]
    entries = _SCRIPT.findall(index)
    if len(entries) != 1:
        raise PageError(_INDEX, "it needs one script of type module")
    styles = _bundled_styles(_STYLE.findall(index), texts)
    first_scripts, scripts = make_bundles(Modules.reached_from(entries[0], texts.get))
    icons = {name: texts[name] for name in _ICON.findall(index)}
    made = shorten({**styles, **scripts, **icons})
    first = (*styles, *first_scripts)
    version = _digest([index, *(f"{name}\n{text}" for name, text in made.items())])
    head, foot = _frame(index, version, list(styles), first_scripts)
    return AssembledPage(
        version, head, foot, {name: _file(name, text) for name, text in made.items()}, first
    )


def _bundled_styles(paths: list[str], texts: Mapping[str, str]) -> dict[str, str]:
    """Return the style sheets that the page names, in few files, in the same order."""
    squeezed: dict[str, str] = {}
    for path in paths:
        if path not in texts:
            raise PageError(_INDEX, f"there is no web/{path}")
        squeezed[path] = squeeze(path, texts[path])
        if (found := _IMPORT_OF_STYLE.search(squeezed[path])) is not None:
            raise PageError(path, f"a style sheet must not load another file: {found[0]}")
    return {
        f"style-{number}.css": "".join(squeezed[path] for path in portion)
        for number, portion in enumerate(pack(squeezed), 1)
    }


def _frame(index: str, version: str, styles: list[str], scripts: list[str]) -> tuple[str, str]:
    """Return the page around the first frame, with the names of the bundles in it."""
    base = f"/web/v/{version}"
    links = [f'<meta name="page-version" content="{version}">']
    links += [f'<link rel="stylesheet" href="{base}/{name}">' for name in styles]
    links += [f'<link rel="modulepreload" href="{base}/{name}">' for name in scripts]
    links += [f'<script type="module" src="{base}/{scripts[-1]}"></script>\n']
    text = _SCRIPT.sub("\n".join(links), _STYLE.sub("", index))
    text = _ICON.sub(rf'href="{base}/\1"', text)
    head, end, foot = text.rpartition("</body>")
    if not end:
        raise PageError(_INDEX, "it needs an end of its body")
    return head, end + foot


def _file(name: str, text: str) -> PageFile:
    media_type = MEDIA_TYPES[PurePosixPath(name).suffix]
    return PageFile.of(text.encode(), media_type, compressed=True)


def _digest(texts: list[str]) -> str:
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()[:12]


def _find_all(folder: Traversable, path: str) -> Iterator[tuple[str, Traversable]]:
    for entry in folder.iterdir():
        if entry.is_dir():
            yield from _find_all(entry, f"{path}{entry.name}/")
        elif PurePosixPath(entry.name).suffix in MEDIA_TYPES:
            yield f"{path}{entry.name}", entry
