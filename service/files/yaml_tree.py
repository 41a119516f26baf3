"""YAML as a tree that remembers where everything stands.

Read event by event: the parser of libyaml is in C and fast, and its composer recurses, so that some
ten thousand opened brackets end the process. Nothing is ever constructed from a tag, and there are
no aliases, so a small file cannot become a large one.
"""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any, Literal, TypeAlias

import yaml

from domain.findings import Finding

MAX_DEPTH = 64
"""Of maps and lists in each other."""

MAX_EVENTS = 2_000_000
"""Keys, values, and begins and ends of maps and lists; four times a model of 10,000 nodes."""

MAX_TAG_DIRECTIVES = 100
"""libyaml compares each with all others, and a megabyte of them takes minutes."""

STRING_TAG = "tag:yaml.org,2002:str"
_QUOTES = ("'", '"')
_LINE_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")


@dataclass(slots=True)
class Scalar:
    """A text, not yet taken as a number or anything else; lines and columns count from 1."""

    line: int
    column: int
    text: str
    is_quoted: bool = False
    tag: str | None = None


@dataclass(slots=True)
class Sequence:
    """A list; an item is None where what stands there was already complained of."""

    line: int
    column: int
    items: "list[Node | None]" = field(default_factory=list)


@dataclass(slots=True)
class Mapping:
    """A map in the order of the text, each key once; a value as in `Sequence`."""

    line: int
    column: int
    entries: "list[tuple[Scalar, Node | None]]" = field(default_factory=list)


Node: TypeAlias = Scalar | Sequence | Mapping


@dataclass(slots=True)
class YamlTree:
    """The documents of a text, and what is wrong with it as YAML."""

    documents: list[Node | None] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)
    is_complete: bool = False
    """False: the reading ended at a fault, and what is missing says nothing."""


def finding_at(
    place: Node,
    code: str,
    message: str,
    part: str | None = None,
    severity: Literal["error", "warning"] = "error",
) -> Finding:
    """Return a finding about what stands at `place`."""
    return Finding(severity, code, message, part, (), place.line, place.column)


def in_order(text: str, findings: Iterable[Finding]) -> list[Finding]:
    """Sort findings by place; what libyaml places after the last line is moved to its end."""
    lines = _LINE_BREAK.split(text)
    last, end = len(lines), len(lines[-1]) + 1
    inside = (replace(f, line=last, column=end) if (f.line or 0) > last else f for f in findings)
    return sorted(inside, key=lambda finding: (finding.line or 0, finding.column or 0))


def read_tree(text: str) -> YamlTree:
    """Read YAML; after a fault of syntax the rest of the text is not looked at."""
    if text.count("%TAG") > MAX_TAG_DIRECTIVES:
        message = f"more than {MAX_TAG_DIRECTIVES} %TAG directives"
        return YamlTree(findings=[Finding("error", "TOO_LARGE", message, line=1, column=1)])
    builder = _Builder()
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
    lines = _LINE_BREAK.split(text[:index])
    message = f"the character U+{code:04X} is not allowed in YAML; is this a text file?"
    return Finding(
        "error", "YAML_SYNTAX", message, line=len(lines), column=len(lines[-1].lstrip("\ufeff")) + 1
    )


def _syntax_error(error: yaml.MarkedYAMLError) -> Finding:
    message = ": ".join(words for words in (error.context, error.problem) if words)
    mark = error.problem_mark or error.context_mark
    line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
    # Since PyYAML 6.0.4 the parser has a bound of its own, and may look so far ahead of its events.
    code = "TOO_DEEP" if error.problem == _PARSERS_BOUND else "YAML_SYNTAX"
    return Finding("error", code, message, line=line, column=column)


_PARSERS_BOUND = "exceeded maximum nesting depth"


@dataclass(slots=True)
class _Open:
    """A map or list whose end has not come yet."""

    node: Sequence | Mapping
    key: Scalar | None = None
    """The key whose value comes next; None: it is one that is left out."""
    expects_value: bool = False
    lines: dict[str, int] = field(default_factory=dict)
    """In which line each key of a map stands."""


class _Builder:
    """Puts the tree together from the events of the parser."""

    def __init__(self) -> None:
        self.tree = YamlTree()
        self._open: list[_Open] = []

    def build(self, next_event: Callable[[], Any]) -> None:
        """Take in all events; the tree is complete unless there is too much of it.

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
                self._add(Scalar(mark.line + 1, mark.column + 1, event.value, is_quoted, event.tag))
            elif kind is yaml.MappingEndEvent or kind is yaml.SequenceEndEvent:
                self._add(self._open.pop().node)
            elif event is None:
                self.tree.is_complete = True
                return
            elif kind is yaml.AliasEvent:
                message = f"*{event.anchor}: aliases are not supported; write the value again"
                self._complain(event, "ALIAS", message)
                self._add(None)
            elif kind is yaml.MappingStartEvent or kind is yaml.SequenceStartEvent:
                if len(self._open) == MAX_DEPTH:
                    message = f"more than {MAX_DEPTH} maps and lists in each other"
                    self._complain(event, "TOO_DEEP", message)
                    return
                begin = Mapping if kind is yaml.MappingStartEvent else Sequence
                self._open.append(_Open(begin(*_position(event))))
        self._complain(event, "TOO_LARGE", f"more than {MAX_EVENTS:,} keys, values and ends")

    def _add(self, node: Node | None) -> None:
        """Put a finished node where it belongs."""
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
        """Return a key that can be used; of two equal ones the first."""
        if not isinstance(key, Scalar) or not key.text:
            if key is not None:
                message = "a key must be a word, not empty and not a map or list"
                self.tree.findings.append(finding_at(key, "INVALID_KEY", message))
            return None
        if key.text == "<<" and not key.is_quoted:
            message = "merge keys are not supported; write the values again"
            self.tree.findings.append(finding_at(key, "MERGE_KEY", message))
            return None
        if key.text in top.lines:
            message = f"{key.text!r} is already in line {top.lines[key.text]}"
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
