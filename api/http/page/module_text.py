"""The text of one ES module: what it imports and exports, and the rest without comments.

This is no parser of JavaScript. It knows the few forms that the modules of the page have, and an
error names any other, so that a bundle is never wrong without anybody noticing.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass

_NAME = r"[A-Za-z_$][\w$]*"
_PATH = r'"/web/(js/[\w/]+\.js)"'
_IMPORT = re.compile(
    rf"^import (?:(?:\{{([\w$\s,]*)\}}|\* as ({_NAME})) from )?{_PATH};\n", re.MULTILINE
)
_EXPORT = re.compile(rf"^export ((?:async )?function\*?|class|const) ({_NAME})", re.MULTILINE)
_LATER = re.compile(rf"\bimport\({_PATH}\)")
_BINDING = re.compile(rf"({_NAME})(?: as ({_NAME}))?")
_UNKNOWN = re.compile(r"^export\b.*|^import\b(?!\().*|\bimport\s*\.\s*meta.*", re.MULTILINE)
_UNKNOWN_LATER = re.compile(r"\bimport\s*\(.*")
# At the outermost level, where no line is indented.
_TOP_LEVEL_AWAIT = re.compile(r"^(?!\s)(?!.*\basync\b).*\bawait\b.*", re.MULTILINE)


class PageError(ValueError):
    """A file of the page has a form that cannot be bundled; it names the file."""

    def __init__(self, path: str, message: str) -> None:
        super().__init__(f"web/{path}: {message}")


@dataclass(frozen=True, slots=True)
class Import:
    """One import statement."""

    path: str
    """Of the other module, below `web/`."""
    names: tuple[tuple[str, str], ...]
    """Exported name and local name of each binding."""
    whole: str | None
    """Local name of all exports together; None: they are not imported together."""

    @property
    def binds(self) -> bool:
        """Tell whether it gives names to anything, and is not only for the effects."""
        return bool(self.names or self.whole)


@dataclass(frozen=True, slots=True)
class Module:
    """One module, taken apart."""

    path: str
    """Below `web/`, such as `js/base/dom.js`."""
    body: str
    """Without imports, without the word `export`, without comments and indentation."""
    imports: tuple[Import, ...]
    exports: tuple[str, ...]
    later: tuple[str, ...]
    """Paths of the modules that it imports on demand."""

    @classmethod
    def read(cls, path: str, text: str) -> "Module":
        """Take a module apart.

        Args:
            path: Below `web/`.
            text: Its source.

        Raises:
            PageError: It has a form that this module does not know.
        """
        _refuse(_TOP_LEVEL_AWAIT, text, path, "a module must not wait while it is loaded")
        body = squeeze(path, text)
        imports = tuple(
            Import(found[3], _bindings(path, found[1]), found[2])
            for found in _IMPORT.finditer(body)
        )
        body = _IMPORT.sub("", body)
        exports = tuple(name for _, name in _EXPORT.findall(body))
        body = _EXPORT.sub(r"\1 \2", body)
        later = tuple(_LATER.findall(body))
        _refuse(_UNKNOWN, body, path, "only plain imports and exports can be bundled")
        _refuse(_UNKNOWN_LATER, _LATER.sub("", body), path, "import() needs a path in quotes")
        return cls(path, body, imports, exports, later)

    def body_with(self, lead: Callable[[str], str]) -> str:
        """Return the body, with another expression for each `import()`.

        Args:
            lead: Returns the expression for the path of a module.
        """
        return _LATER.sub(lambda found: lead(found[1]), self.body)


def squeeze(path: str, text: str) -> str:
    """Return a script or style sheet without whole lines of comment, and without indentation.

    A line can only begin inside a literal if a template goes over lines, or if a string is
    continued on the next one: here, both are errors.

    Args:
        path: For an error.
        text: The source.

    Raises:
        PageError: A literal may go over lines, or code stands behind the end of a comment.
    """
    kept = []
    in_comment = False
    for line in map(str.strip, text.splitlines()):
        if in_comment or line.startswith("/*"):
            in_comment = "*/" not in line
            if not in_comment and line.index("*/") + 2 < len(line):
                raise PageError(path, f"code behind a comment: {line}")
        elif line and not line.startswith("//"):
            if line.count("`") % 2 or line.endswith("\\"):
                raise PageError(path, f"a literal over lines, or a single backtick: {line}")
            kept.append(line)
    return "\n".join(kept) + "\n"


def _bindings(path: str, text: str | None) -> tuple[tuple[str, str], ...]:
    pieces = [piece.strip() for piece in (text or "").split(",") if piece.strip()]
    found = [_BINDING.fullmatch(piece) for piece in pieces]
    if None in found:
        raise PageError(path, f"an import that cannot be bundled: {text}")
    return tuple((match[1], match[2] or match[1]) for match in found if match)


def _refuse(form: re.Pattern[str], text: str, path: str, why: str) -> None:
    if (found := form.search(text)) is not None:
        raise PageError(path, f"{why}: {found[0].strip()}")
