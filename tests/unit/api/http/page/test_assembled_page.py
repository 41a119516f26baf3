"""The page of this repository: what the first use needs, and how large all of it is."""

import re
from importlib.util import find_spec

import pytest

from api.http.page.assembled_page import assemble, assembled_page, sources
from api.http.page.module_text import PageError

MOST_FIRST_FILES = 6
MOST_OF_A_FILE = 14_000
MOST_IN_ALL = 120_000

INDEX = """\
<!doctype html>
<head>
<link rel="icon" href="/web/icon.svg" type="image/svg+xml">
<link rel="stylesheet" href="/web/style/a.css">
<link rel="stylesheet" href="/web/style/b.css">
<script type="module" src="/web/js/main.js"></script>
</head>
<body>
<p>One</p>
</body>
</html>
"""
FILES = {
    "index.html": INDEX,
    "icon.svg": "<svg/>",
    "style/a.css": "a {}\n",
    "style/b.css": "b {}\n",
    "js/main.js": "/* Runs. */\nrun();\n",
}


def sizes() -> dict[str, int]:
    return {name: len(file.stored) for name, file in assembled_page().files.items()}


def test_the_first_use_needs_few_files_that_each_arrive_at_once() -> None:
    first = {name: sizes()[name] for name in assembled_page().first}

    assert len(first) <= MOST_FIRST_FILES, first
    assert max(first.values()) <= MOST_OF_A_FILE, first


@pytest.mark.skipif(find_spec("minify") is None, reason="there is no library that shortens it")
def test_the_whole_page_is_small() -> None:
    assert sum(sizes().values()) < MOST_IN_ALL, sizes()


def test_every_script_and_style_sheet_of_the_page_is_used() -> None:
    written = [path for path in sources() if path.startswith(("js/", "style/"))]
    texts = "".join(sources().values())
    unused = {path for path in written if f"/web/{path}" not in texts}

    assert not unused


def test_the_page_names_its_files_by_version_the_style_sheet_first() -> None:
    page = assemble(FILES)

    base = f"/web/v/{page.version}"
    assert (
        page.head + page.foot
        == f"""\
<!doctype html>
<head>
<link rel="icon" href="{base}/icon.svg" type="image/svg+xml">
<meta name="page-version" content="{page.version}">
<link rel="stylesheet" href="{base}/style-1.css">
<link rel="modulepreload" href="{base}/core-1.js">
<script type="module" src="{base}/core-1.js"></script>
</head>
<body>
<p>One</p>
</body>
</html>
"""
    )
    assert page.foot.startswith("</body>")
    assert page.first == ("style-1.css", "core-1.js")
    assert page.files["style-1.css"].content == b"a {}\nb {}\n"
    assert page.files["icon.svg"].media_type == "image/svg+xml"
    assert re.fullmatch(r"[0-9a-f]{12}", page.version)


@pytest.mark.parametrize("path", FILES)
def test_another_content_is_another_version_whatever_changes(path: str) -> None:
    changed = {**FILES, path: FILES[path].replace("run", "go").replace("{}", "{b: 0}")}
    changed[path] = changed[path].replace("<svg/>", "<svg></svg>").replace("One", "Two")

    assert assemble(changed).version != assemble(FILES).version
    assert assemble(FILES).version == assemble(dict(FILES)).version


@pytest.mark.parametrize(
    ("path", "text", "why"),
    [
        ("index.html", "<body></body>", "one script of type module"),
        ("index.html", INDEX.replace("</body>", ""), "an end of its body"),
        ("index.html", INDEX.replace("a.css", "c.css"), "there is no web/style/c.css"),
        ("style/a.css", '@import "b.css";\n', "must not load another file"),
        ("style/a.css", "a { background: url(b.png); }\n", "must not load another file"),
    ],
)
def test_a_page_that_cannot_be_put_together_is_an_error(path: str, text: str, why: str) -> None:
    with pytest.raises(PageError, match=why):
        assemble({**FILES, path: text})
