"""YAML as a tree with line and column of every node.

Read event by event: the libyaml parser is in C and fast, but its composer recurses, so that some
ten thousand open brackets crash the process. Tags never construct objects. Aliases are errors but
where the caller takes them; there, who walks the tree meets the same node repeatedly, and has to
bound what a small file can expand to.
"""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any, Literal, TypeAlias

import yaml

from domain.findings import Finding

MAX_DEPTH = 64
"""Largest depth of nested maps and lists."""

MAX_EVENTS = 2_000_000
"""Keys, values, and starts and ends of maps and lists; four times a model of 10,000 nodes."""

MAX_TAG_DIRECTIVES = 100
"""libyaml compares each with all others; a megabyte of them takes minutes."""

STRING_TAG = "tag:yaml.org,2002:str"
_QUOTES = ("'", '"')
_LINE_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")


@dataclass(slots=True)
class Scalar:
    """An uninterpreted scalar; lines and columns count from 1."""

    line: int
    column: int
    text: str
    is_quoted: bool = False
    tag: str | None = None


@dataclass(slots=True)
class Sequence:
    """A list; an item is None if a finding has been reported for it."""

    line: int
    column: int
    items: "list[Node | None]" = field(default_factory=list)


@dataclass(slots=True)
class Mapping:
    """A mapping in the order of the text, with unique keys; values as in `Sequence`."""

    line: int
    column: int
    entries: "list[tuple[Scalar, Node | None]]" = field(default_factory=list)


Node: TypeAlias = Scalar | Sequence | Mapping


@dataclass(slots=True)
class YamlTree:
    """The documents of a text, and the YAML errors."""

    documents: list[Node | None] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)
    is_complete: bool = False
    """False: reading stopped at an error, so that missing keys mean nothing."""


def finding_at(
    place: Node,
    code: str,
    message: str,
    part: str | None = None,
    severity: Literal["error", "warning"] = "error",
) -> Finding:
    """Return a finding with line and column of `place`.

    Args:
        place: What the finding is about.
        code: Stable, UPPER_SNAKE.
        message: The finding in words.
        part: Name of the part concerned, if any.
        severity: Whether the file cannot be used, or only looks wrong.
    """
    return Finding(severity, code, message, part, (), place.line, place.column)


def lines_of_yaml(text: str) -> list[str]:
    """Return the lines of a text as libyaml counts them."""
    return _LINE_BREAK.split(text)


def in_order(text: str, findings: Iterable[Finding]) -> list[Finding]:
    """Sort findings by place; places that libyaml reports after the last line move to its end."""
    lines = lines_of_yaml(text)
    last, end = len(lines), len(lines[-1]) + 1
    inside = (replace(f, line=last, column=end) if (f.line or 0) > last else f for f in findings)
    return sorted(inside, key=lambda finding: (finding.line or 0, finding.column or 0))


def no_alias(_keys: list[str]) -> bool:
    """Take aliases nowhere."""
    return False


def read_tree(text: str, takes_alias: Callable[[list[str]], bool] = no_alias) -> YamlTree:
    """Read YAML; reading stops at a syntax error.

    Args:
        text: The text of the file.
        takes_alias: Tells whether an alias below these keys is only a warning, and stands for the
            node that it names. The last key is empty where the alias is itself a key.
    """
    if text.count("%TAG") > MAX_TAG_DIRECTIVES:
        message = f"more than {MAX_TAG_DIRECTIVES} %TAG directives"
        return YamlTree(findings=[Finding("error", "TOO_LARGE", message, line=1, column=1)])
    builder = _Builder(takes_alias)
    try:
        builder.build(yaml.CSafeLoader(text).get_event)
    except UnicodeEncodeError as error:
        builder.tree.findings.append(_bad_character(text, text[error.start], error.start))
    except yaml.reader.ReaderError as error:
        before = text.encode()[: error.position].decode(errors="ignore")
        builder.tree.findings.append(_bad_character(text, error.character, len(before)))
    except yaml.MarkedYAMLError as error:
        builder.tree.findings.append(_syntax_error(error))
    return builder.tree


def _bad_character(text: str, character: str | int, index: int) -> Finding:
    code = ord(character) if isinstance(character, str) else character
    lines = lines_of_yaml(text[:index])
    message = f"the character U+{code:04X} is not allowed in YAML; is this a text file?"
    return Finding(
        "error", "YAML_SYNTAX", message, line=len(lines), column=len(lines[-1].lstrip("\ufeff")) + 1
    )


def _syntax_error(error: yaml.MarkedYAMLError) -> Finding:
    message = ": ".join(words for words in (error.context, error.problem) if words)
    mark = error.problem_mark or error.context_mark
    line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
    # Since PyYAML 6.0.4 the parser has its own limit, and may reach it ahead of its events.
    code = "TOO_DEEP" if error.problem == _PARSERS_BOUND else "YAML_SYNTAX"
    return Finding("error", code, message, line=line, column=column)


_PARSERS_BOUND = "exceeded maximum nesting depth"


@dataclass(slots=True)
class _Open:
    """A mapping or list that is still open."""

    node: Sequence | Mapping
    anchor: str | None
    key: Scalar | None = None
    """The key whose value comes next; None: it is invalid and left out."""
    expects_value: bool = False
    lines: dict[str, int] = field(default_factory=dict)
    """Line of each key of a mapping."""


class _Builder:
    """Builds the tree from the events of the parser."""

    def __init__(self, takes_alias: Callable[[list[str]], bool]) -> None:
        self.tree = YamlTree()
        self._takes_alias = takes_alias
        self._open: list[_Open] = []
        self._anchors: dict[str, Node] = {}
        """The finished nodes of the document that have an anchor."""

    def build(self, next_event: Callable[[], Any]) -> None:
        """Process all events; the tree is complete unless it is too large.

        Raises:
            yaml.YAMLError: The text is not YAML.
        """
        event: Any = None
        for _ in range(MAX_EVENTS):
            event = next_event()
            kind = type(event)
            if kind is yaml.ScalarEvent:
                mark = event.start_mark
                is_quoted = event.style in _QUOTES
                scalar = Scalar(mark.line + 1, mark.column + 1, event.value, is_quoted, event.tag)
                self._finish(scalar, event.anchor)
            elif kind is yaml.MappingEndEvent or kind is yaml.SequenceEndEvent:
                ended = self._open.pop()
                self._finish(ended.node, ended.anchor)
            elif event is None:
                self.tree.is_complete = True
                return
            elif kind is yaml.AliasEvent:
                self._add(self._aliased(event))
            elif kind is yaml.MappingStartEvent or kind is yaml.SequenceStartEvent:
                if len(self._open) == MAX_DEPTH:
                    message = f"more than {MAX_DEPTH} levels of nested maps and lists"
                    self._complain(event, "TOO_DEEP", message)
                    return
                begin = Mapping if kind is yaml.MappingStartEvent else Sequence
                self._open.append(_Open(begin(*_position(event)), event.anchor))
            elif kind is yaml.DocumentStartEvent:
                self._anchors.clear()
        self._complain(event, "TOO_LARGE", f"more than {MAX_EVENTS:,} keys, values and ends")

    def _finish(self, node: Node, anchor: str | None) -> None:
        """Add a finished node, and remember it by its anchor."""
        if anchor is not None:
            self._anchors[anchor] = node
        self._add(node)

    def _aliased(self, event: yaml.AliasEvent) -> Node | None:
        """Return the node that an alias stands for; None: it stands for none, or must not."""
        keys = [
            level.key.text if level.key is not None and level.expects_value else ""
            for level in self._open
            if isinstance(level.node, Mapping)
        ]
        if not self._takes_alias(keys):
            message = f"*{event.anchor}: aliases are not supported; repeat the value"
            self._complain(event, "ALIAS", message)
            return None
        node = self._anchors.get(event.anchor or "")
        if node is None:
            self._complain(event, "ALIAS", f"*{event.anchor}: no value before it has that anchor")
            return None
        message = f"*{event.anchor}: the YAML reader of ROS 2 rejects aliases; repeat the value"
        line, column = _position(event)
        self.tree.findings.append(
            Finding("warning", "NOT_FOR_CPP", message, line=line, column=column)
        )
        return node

    def _add(self, node: Node | None) -> None:
        """Add a finished node to its parent."""
        if not self._open:
            self.tree.documents.append(node)
            return
        top = self._open[-1]
        if isinstance(top.node, Sequence):
            top.node.items.append(node)
        elif not top.expects_value:
            top.key = self._checked_key(top, node)
            top.expects_value = True
        else:
            top.expects_value = False
            if top.key is not None:
                top.node.entries.append((top.key, node))

    def _checked_key(self, top: _Open, key: Node | None) -> Scalar | None:
        """Return a valid key; None, with a finding, for an invalid or duplicate one."""
        if not isinstance(key, Scalar) or not key.text:
            if key is not None:
                message = "a key must be a non-empty scalar, not a map or list"
                self.tree.findings.append(finding_at(key, "INVALID_KEY", message))
            return None
        if key.text == "<<" and not key.is_quoted:
            message = "merge keys are not supported; repeat the values"
            self.tree.findings.append(finding_at(key, "MERGE_KEY", message))
            return None
        if key.text in top.lines:
            message = f"duplicate key {key.text!r}; first in line {top.lines[key.text]}"
            self.tree.findings.append(finding_at(key, "DUPLICATE_KEY", message))
            return None
        top.lines[key.text] = key.line
        return key

    def _complain(self, event: yaml.Event, code: str, message: str) -> None:
        line, column = _position(event)
        self.tree.findings.append(Finding("error", code, message, line=line, column=column))


def _position(event: yaml.Event) -> tuple[int, int]:
    mark = event.start_mark
    return (mark.line + 1, mark.column + 1) if mark else (1, 1)
