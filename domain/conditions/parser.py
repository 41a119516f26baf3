"""Reads conditions: a subset of the expressions of Python, by recursive descent.

The parser of Python itself reads far more than a condition may hold, warns through a global
filter, and words its errors differently from release to release.
"""

from typing import NoReturn

from domain.conditions.lexer import ConditionSyntaxError, Token, TokenKind, number_of, tokens
from domain.conditions.operands import (
    ListLiteral,
    Literal,
    Name,
    Operand,
    Term,
    as_condition,
    compared,
    joined,
    not_a_value,
    turned_round,
)
from domain.conditions.tree import (
    ATTRIBUTES,
    RESERVED_WORDS,
    AllOf,
    AnyOf,
    Node,
    Operator,
    Subject,
    Topic,
    TopicKind,
    is_keyword,
)
from domain.errors import near_match

MAX_DEPTH = 20
"""How deep parentheses may be nested."""

_CALLS = {"part": TopicKind.PART, "signal": TopicKind.SIGNAL, "hold": TopicKind.HOLD}
_TRUTHS = {"true": True, "false": False}
_OF_PYTHON = {
    "True": "write true",
    "False": "write false",
    "None": "there is no None; a part without a mode equals no mode",
    "is": "write == to compare",
}


def parse(text: str) -> Node:
    """Return the tree of a condition.

    Raises:
        ConditionSyntaxError: It is not one.
    """
    return _Parser(text).parse()


class _Parser:
    def __init__(self, text: str) -> None:
        self._tokens = tokens(text)
        self._token = next(self._tokens)
        self._depth = 0

    def parse(self) -> Node:
        if self._is_at_end:
            self._fail("the condition is empty")
        node = as_condition(self._either(negate=False), negate=False)
        if not self._is_at_end:
            self._fail_unexpected("an operator")
        return node

    # --- and, or, not ----------------------------------------------------------------------------

    def _either(self, *, negate: bool) -> Term:
        first = self._both(negate=negate)
        if not self._is_word("or"):
            return first
        operands = [as_condition(first, negate=negate)]
        while self._take_word("or"):
            operands.append(as_condition(self._both(negate=negate), negate=negate))
        return joined(operands, AllOf if negate else AnyOf)

    def _both(self, *, negate: bool) -> Term:
        first = self._negated(negate=negate)
        if not self._is_word("and"):
            return first
        operands = [as_condition(first, negate=negate)]
        while self._take_word("and"):
            operands.append(as_condition(self._negated(negate=negate), negate=negate))
        return joined(operands, AnyOf if negate else AllOf)

    def _negated(self, *, negate: bool) -> Term:
        if not self._is_word("not"):
            return self._comparison(negate=negate)
        while self._take_word("not"):
            negate = not negate
        return as_condition(self._comparison(negate=negate), negate=negate)

    # --- comparisons -----------------------------------------------------------------------------

    def _comparison(self, *, negate: bool) -> Term:
        start = self._token
        left = self._operand(negate=negate)
        sign = self._token
        operator = self._take_operator()
        if operator is None:
            return left
        if not isinstance(left, Operand):
            raise ConditionSyntaxError("a whole condition cannot be compared", start.column)
        start = self._token
        right = self._operand(negate=False)
        if not isinstance(right, Operand):
            raise ConditionSyntaxError("a whole condition cannot be compared", start.column)
        again = self._token
        if self._take_operator() is not None:
            message = "only one comparison at a time: join two of them by and"
            raise ConditionSyntaxError(message, again.column)
        leaf = compared(left, operator, right, sign.column)
        return turned_round(leaf) if negate else leaf

    def _take_operator(self) -> Operator | None:
        token = self._token
        if token.kind is TokenKind.SIGN and token.text in set(Operator):
            self._advance()
            return Operator(token.text)
        if self._take_word("in"):
            return Operator.IN
        if token.kind is TokenKind.WORD and token.text == "not":
            self._advance()
            if not self._take_word("in"):
                self._fail_unexpected("in")
            return Operator.NOT_IN
        return None

    # --- operands --------------------------------------------------------------------------------

    def _operand(self, *, negate: bool) -> Term:
        token = self._token
        if token.kind is TokenKind.WORD:
            return self._word()
        if self._take_sign("("):
            self._enter(token)
            term = self._either(negate=negate)
            self._expect(")")
            self._depth -= 1
            return term
        if self._take_sign("["):
            return self._list(token)
        return self._constant()

    def _constant(self) -> Literal:
        token = self._token
        if token.kind is TokenKind.STRING:
            self._advance()
            return Literal(token.text, token.column)
        negative = self._take_sign("-")
        if not negative:
            self._take_sign("+")
        if self._token.kind is not TokenKind.NUMBER:
            self._fail_unexpected("a number" if self._token is not token else "a name or a value")
        number = number_of(self._token)
        self._advance()
        return Literal(-number if negative else number, token.column)

    def _list(self, opening: Token) -> ListLiteral:
        values: list[Literal] = []
        while not self._take_sign("]"):
            values.append(self._list_item())
            if not self._take_sign(","):
                self._expect("]")
                break
        return ListLiteral(tuple(values), opening.column)

    def _list_item(self) -> Literal:
        token = self._token
        if token.kind is not TokenKind.WORD:
            return self._constant()
        item = self._word()
        if isinstance(item, Subject):
            raise not_a_value(item)
        return Literal(item.text, item.column) if isinstance(item, Name) else item

    # --- names -----------------------------------------------------------------------------------

    def _word(self) -> Subject | Name | Literal:
        """Read a name with what follows it, or true or false."""
        token = self._token
        self._advance()
        word = token.text
        if word in _TRUTHS:
            return Literal(_TRUTHS[word], token.column)
        if word in ("and", "or", "not", "in"):
            raise ConditionSyntaxError(f"something is missing before {word!r}", token.column)
        if is_keyword(word):
            other = f"a word of Python; write signal('{word}') or part('{word}')"
            words = _OF_PYTHON.get(word, other)
            raise ConditionSyntaxError(f"{word!r}: {words}", token.column)
        if self._is_sign("("):
            return self._call(token)
        if word in RESERVED_WORDS:
            return self._reserved(token)
        if not self._is_sign("."):
            return Name(word, token.column)
        return self._attribute_of(Topic(TopicKind.PART, word), token)

    def _call(self, token: Token) -> Subject:
        kind = _CALLS.get(token.text)
        if kind is None:
            message = f"{token.text!r} cannot be called; only part, signal and hold can"
            raise ConditionSyntaxError(message, token.column)
        self._expect("(")
        name = self._token
        if name.kind is not TokenKind.STRING:
            self._fail_unexpected("a name in quotes")
        if not name.text:
            self._fail("the name is empty")
        self._advance()
        self._expect(")")
        topic = Topic(kind, name.text)
        if kind is TopicKind.PART:
            return self._attribute_of(topic, token)
        return Subject(topic, column=token.column)

    def _reserved(self, token: Token) -> Subject:
        word = token.text
        if word in ("part", "signal"):
            self._fail(f"write {word}('NAME')")
        kind = TopicKind(word)
        if kind not in (TopicKind.ERROR, TopicKind.HOLD):
            return self._attribute_of(Topic(kind), token)
        if not self._is_sign("."):
            self._fail(f"{word} of what? Write {word}.NAME")
        return Subject(Topic(kind, self._name_after_dot()), column=token.column)

    def _attribute_of(self, topic: Topic, start: Token) -> Subject:
        known = ATTRIBUTES[topic.kind]
        if not self._is_sign("."):
            self._fail(f"a dot and one of {', '.join(known)} is missing")
        dot = self._token
        attribute = self._name_after_dot()
        if attribute not in known:
            column = dot.column + 1
            raise ConditionSyntaxError(_unknown_attribute(topic, attribute, known), column)
        if attribute == "errors":
            error = self._name_after_dot()
            return Subject(Topic(TopicKind.ERROR, error, topic.name), column=start.column)
        key = self._name_after_dot() if attribute == "parameters" else ""
        while key and self._is_sign("."):
            key += f".{self._name_after_dot()}"
        return Subject(topic, attribute, key, start.column)

    def _name_after_dot(self) -> str:
        self._expect(".")
        token = self._token
        if token.kind is not TokenKind.WORD:
            self._fail_unexpected("a name")
        self._advance()
        return token.text

    # --- tokens ----------------------------------------------------------------------------------

    def _advance(self) -> None:
        self._token = next(self._tokens)

    @property
    def _is_at_end(self) -> bool:
        return self._token.kind is TokenKind.END

    def _is_word(self, word: str) -> bool:
        return self._token.kind is TokenKind.WORD and self._token.text == word

    def _take_word(self, word: str) -> bool:
        found = self._is_word(word)
        if found:
            self._advance()
        return found

    def _is_sign(self, sign: str) -> bool:
        return self._token.kind is TokenKind.SIGN and self._token.text == sign

    def _take_sign(self, sign: str) -> bool:
        found = self._is_sign(sign)
        if found:
            self._advance()
        return found

    def _expect(self, sign: str) -> None:
        if not self._take_sign(sign):
            self._fail_unexpected(repr(sign))

    def _enter(self, opening: Token) -> None:
        self._depth += 1
        if self._depth > MAX_DEPTH:
            message = f"parentheses are nested deeper than {MAX_DEPTH}"
            raise ConditionSyntaxError(message, opening.column)

    def _fail(self, message: str) -> NoReturn:
        raise ConditionSyntaxError(message, self._token.column)

    def _fail_unexpected(self, wanted: str) -> NoReturn:
        token = self._token
        if token.kind is TokenKind.SIGN and token.text in "+-":
            self._fail("a condition does not calculate; a name with signs needs quotes")
        if token.kind is TokenKind.WORD and token.text in _OF_PYTHON:
            self._fail(f"{token.text!r}: {_OF_PYTHON[token.text]}")
        self._fail(f"expected {wanted}, found {token.shown}")


def _unknown_attribute(topic: Topic, attribute: str, known: tuple[str, ...]) -> str:
    what = topic.name or str(topic.kind)
    near = near_match(attribute, known)
    hint = f"did you mean {near}?" if near else f"it has {', '.join(known)}"
    message = f"{what} has no {attribute!r}; {hint}"
    if topic.kind is not TopicKind.PART and attribute in ATTRIBUTES[TopicKind.PART]:
        message += f" A part of this name is written part('{topic.kind}')."
    return message
