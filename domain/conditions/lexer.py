"""Cuts the text of a condition into words, numbers, quoted names and operators."""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum, auto

from domain.errors import InvalidValueError

MAX_LENGTH = 500
"""Characters of a condition."""


class ConditionSyntaxError(InvalidValueError):
    """A condition that cannot be read.

    Args:
        message: What is wrong.
        column: Where, from 1, in characters.
    """

    code = "CONDITION_SYNTAX"

    def __init__(self, message: str, column: int) -> None:
        super().__init__(message)
        self.column = column


class TokenKind(Enum):
    """Kinds of tokens."""

    WORD = auto()
    NUMBER = auto()
    STRING = auto()
    SIGN = auto()
    """An operator or a bracket."""
    END = auto()


@dataclass(frozen=True, slots=True)
class Token:
    """The smallest part of a condition."""

    kind: TokenKind
    text: str
    """As it is written; for a string, what is between the quotes."""
    column: int
    """From 1, in characters."""

    @property
    def shown(self) -> str:
        """Return it as messages show it."""
        return "the end" if self.kind is TokenKind.END else repr(self.text)


_TOKEN = re.compile(
    r"""
    (?P<NUMBER> (?: [0-9][0-9_]* (?:\.[0-9_]*)? | \.[0-9][0-9_]* ) (?:[eE][+-]?[0-9]+)? )
  | (?P<WORD>   [^\W\d]\w* )
  | (?P<STRING> '[^'\\]*' | "[^"\\]*" )
  | (?P<SIGN>   == | != | <= | >= | [<>()\[\],.+-] )
    """,
    re.VERBOSE,
)
_NUMBER = re.compile(
    r"(?:(?:0|[1-9](?:_?[0-9])*)(?:\.(?:[0-9](?:_?[0-9])*)?)?|\.[0-9](?:_?[0-9])*)(?:e[+-]?[0-9]+)?"
)
_INSTEAD = {
    "=": "write == to compare",
    "!": "write not, or != to compare",
    "&": "write and",
    "|": "write or",
    "\\": "a backslash is not allowed",
    "'": "the quote is not closed",
    '"': "the quote is not closed",
    "\n": "a condition is one line",
    "\r": "a condition is one line",
    **dict.fromkeys("*/%~^@", "a condition does not calculate"),
}


def tokens(text: str) -> Iterator[Token]:
    """Yield the tokens of a text, and at last one of kind `END`.

    Raises:
        ConditionSyntaxError: The text is too long, or holds what no condition has.
    """
    if len(text) > MAX_LENGTH:
        message = f"a condition has at most {MAX_LENGTH} characters, not {len(text)}"
        raise ConditionSyntaxError(message, MAX_LENGTH + 1)
    end = len(text.rstrip())
    at = len(text) - len(text.lstrip())
    while at < end:
        if text[at] in " \t":
            at += 1
            continue
        token = _token_at(text, at)
        yield token
        at += len(token.text) + (2 if token.kind is TokenKind.STRING else 0)
    yield Token(TokenKind.END, "", end + 1)


def number_of(token: Token) -> int | float:
    """Return the value of a number.

    Raises:
        ConditionSyntaxError: It is too large.
    """
    text = token.text.replace("_", "")
    number = float(text)
    if not math.isfinite(number):
        raise ConditionSyntaxError(f"{text[:20]}... is too large", token.column)
    return int(text) if text.isdigit() else number


def _token_at(text: str, at: int) -> Token:
    column = at + 1
    found = _TOKEN.match(text, at)
    if found is None or found.lastgroup is None:
        character = text[at]
        instead = _INSTEAD.get(character, f"{character!r} is not allowed here")
        raise ConditionSyntaxError(instead, column)
    token = Token(TokenKind[found.lastgroup], found[0], column)
    if token.kind is TokenKind.NUMBER:
        _check_number(text, token)
    if token.kind is not TokenKind.STRING:
        return token
    content = token.text[1:-1]
    for offset, character in enumerate(content, start=1):
        if not character.isprintable():
            raise ConditionSyntaxError(f"{character!r} is not allowed in quotes", column + offset)
    return Token(token.kind, content, column)


def _check_number(text: str, token: Token) -> None:
    """Reject `007`, `1__0`, and a number that runs into a word, as `3m` or `0x1F` do."""
    end = token.column - 1 + len(token.text)
    runs_on = re.compile(r"\w*").match(text, end)
    rest = runs_on[0] if runs_on else ""
    if rest or not _NUMBER.fullmatch(token.text.lower()):
        written = token.text + rest
        shown = written if len(written) <= 20 else f"{written[:20]}..."
        message = f"{shown!r} is neither a number nor a word; a name like this needs quotes"
        raise ConditionSyntaxError(message, token.column)
