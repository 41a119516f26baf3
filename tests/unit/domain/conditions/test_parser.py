"""What a condition means, what is rejected, and that Python reads it in the same way."""

import ast
import random

import pytest

from domain.conditions.lexer import ConditionSyntaxError
from domain.conditions.parser import MAX_DEPTH, parse
from domain.conditions.tree import Comparison, Node, Topic, TopicKind, comparisons


def _subject(text: str) -> tuple[Topic, str, str]:
    (leaf,) = comparisons(parse(text))
    return leaf.subject.topic, leaf.subject.attribute, leaf.subject.key


@pytest.mark.parametrize(
    ("text", "topic", "attribute", "key"),
    [
        ("battery_level >= 0.3", Topic(TopicKind.SIGNAL, "battery_level"), "", ""),
        ("signal('scan rate') < 5", Topic(TopicKind.SIGNAL, "scan rate"), "", ""),
        ("drive_base.state == active", Topic(TopicKind.PART, "drive_base"), "state", ""),
        ("part('left/arm').reachable", Topic(TopicKind.PART, "left/arm"), "reachable", ""),
        ("part('task').converged", Topic(TopicKind.PART, "task"), "converged", ""),
        ("a.parameters.pid.kp < 2", Topic(TopicKind.PART, "a"), "parameters", "pid.kp"),
        ("a.parameters.lambda < 2", Topic(TopicKind.PART, "a"), "parameters", "lambda"),
        ("error.GPS_LOST", Topic(TopicKind.ERROR, "GPS_LOST"), "", ""),
        ("lidar.errors.SILENT", Topic(TopicKind.ERROR, "SILENT", "lidar"), "", ""),
        ("part('l/r').errors.SILENT", Topic(TopicKind.ERROR, "SILENT", "l/r"), "", ""),
        ("robot.state != ERROR", Topic(TopicKind.ROBOT), "state", ""),
        ("task.status == RUNNING_TASK", Topic(TopicKind.TASK), "status", ""),
        ("task.progress > 0.5", Topic(TopicKind.TASK), "progress", ""),
        ("vehicle.speed_mps < 0.05", Topic(TopicKind.VEHICLE), "speed_mps", ""),
        ("hold.operator", Topic(TopicKind.HOLD, "operator"), "", ""),
        ("hold('reaction:LIMP')", Topic(TopicKind.HOLD, "reaction:LIMP"), "", ""),
    ],
)
def test_each_thing_has_its_own_words(text: str, topic: Topic, attribute: str, key: str) -> None:
    assert _subject(text) == (topic, attribute, key)


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("0.3 <= battery_level", "battery_level >= 0.3"),
        ("CONNECTED == signal('x y')", "signal('x y') == CONNECTED"),
        ("active == a.state", "a.state == active"),
        ("SLOW != a.mode", "a.mode != SLOW"),
        ("'CONNECTED' == strength", "strength == CONNECTED"),
        ("(estop)", "estop"),
        ("estop == true", "estop"),
        ("estop != true", "not estop"),
        ("x == signal('y')", "signal('y') == x"),
        ("((x)) < (3)", "x < 3"),
        ("x < -1", "x < - 1"),
        ("x < +1", "x < 1"),
        ("x in [A, 'B', ]", "x in [A, B]"),
        ("not not x", "x"),
        ("not x < 1", "x >= 1"),
        ("not x >= 1", "x < 1"),
        ("not x > 1", "x <= 1"),
        ("not x == A", "x != A"),
        ("not x in [A]", "x not in [A]"),
        ("not x not in [A]", "x in [A]"),
        ("not (x and y < 1)", "not x or y >= 1"),
        ("not (x or not y)", "not x and y"),
        ("not (x and (y or z))", "not x or (not y and not z)"),
        ("a and (b and c)", "a and b and c"),
        ("a or b and c", "a or (b and c)"),
        ("not a and b", "(not a) and b"),
        ("not true", "false"),
    ],
)
def test_two_ways_to_write_the_same(text: str, same: str) -> None:
    assert parse(text) == parse(same)


@pytest.mark.parametrize(
    ("text", "column", "message"),
    [
        ("", 1, "the condition is empty"),
        ("x ==", 5, "expected a name or a value, found the end"),
        ("x and", 6, "expected a name or a value, found the end"),
        ("and x", 1, "something is missing before 'and'"),
        ("not", 4, "expected a name or a value, found the end"),
        ("(x", 3, "expected '\\)', found the end"),
        ("x)", 2, "expected an operator, found '\\)'"),
        ("x y", 3, "expected an operator, found 'y'"),
        ("x not A", 7, "expected in, found 'A'"),
        ("a < 1 < 2", 7, "only one comparison at a time: join two of them by and"),
        ("a == b == c", 8, "only one comparison at a time"),
        ("a < 1 not in [2]", 7, "only one comparison at a time"),
        ("x + 1 < 3", 3, "a condition does not calculate"),
        ("x - 1 < 3", 3, "a condition does not calculate"),
        ("x < --3", 6, "a condition does not calculate"),
        ("-x < 3", 2, "expected a number, found 'x'"),
        ("1", 1, "a value alone is no condition"),
        ("'x'", 1, "a value alone is no condition"),
        ("[A]", 1, "a value alone is no condition"),
        ("x and 1", 7, "a value alone is no condition"),
        ("1 < 2", 3, "one side must be a name"),
        ("x < [1]", 5, "a list follows in, not <"),
        ("[1] == x", 1, "a list follows in, not =="),
        ("x in A", 6, "write a list after in"),
        ("x in (A, B)", 8, "expected '\\)', found ','"),
        ("1 in [1]", 1, "a name is missing before the list"),
        ("x in [[1]]", 7, "expected a name or a value"),
        ("x in [A B]", 9, "expected '\\]', found 'B'"),
        ("x in [a.state]", 7, "a.state is a fact; compare with a number or a word"),
        ("a.state == b.state", 12, "b.state is a fact"),
        ("(a and b) == c", 1, "a whole condition cannot be compared"),
        ("c == (a and b)", 6, "a whole condition cannot be compared"),
        ("x == True", 6, "'True': write true"),
        ("a.mode == None", 11, "a part without a mode equals no mode"),
        ("x is A", 3, "'is': write == to compare"),
        ("lambda < 3", 1, r"write signal\('lambda'\) or part\('lambda'\)"),
        ("a.mode == HIGH-SPEED", 15, "a name with signs needs quotes"),
        ("f'x'", 2, "expected an operator, found 'x'"),
        ("foo('x')", 1, "'foo' cannot be called; only part, signal and hold can"),
        ("error('x')", 1, "'error' cannot be called"),
        ("part(x).state == active", 6, "expected a name in quotes"),
        ("part('').state == active", 6, "the name is empty"),
        ("part('x')", 10, "one of state, mode, reachable, converged, parameters, errors"),
        ("part", 5, "write part\\('NAME'\\)"),
        ("signal < 3", 8, "write signal\\('NAME'\\)"),
        ("hold", 5, "write hold.NAME"),
        ("error", 6, "write error.NAME"),
        ("robot == ERROR", 7, "a dot and one of state is missing"),
        ("a.", 3, "expected a name, found the end"),
        ("a.5", 2, "expected an operator, found '.5'"),
        ("a.sate == active", 3, "a has no 'sate'; did you mean state"),
        ("left.arm.state == active", 6, "left has no 'arm'; it has state, mode"),
        ("a.parameters < 3", 14, "expected '.', found '<'"),
        ("task.mode == FAST", 6, r"A part of this name is written part\('task'\)"),
        ("error.A.b", 8, "expected an operator, found '.'"),
        ("x[0] < 1", 2, "expected an operator, found '\\['"),
        ("x == 1, 2", 7, "expected an operator, found ','"),
    ],
)
def test_what_is_no_condition_is_told_with_its_column(text: str, column: int, message: str) -> None:
    with pytest.raises(ConditionSyntaxError, match=f"(?i){message}") as caught:
        parse(text)

    assert (caught.value.code, caught.value.column) == ("CONDITION_SYNTAX", column)


def test_parentheses_are_nested_so_deep_and_no_deeper() -> None:
    parse("(" * MAX_DEPTH + "x" + ")" * MAX_DEPTH)

    with pytest.raises(ConditionSyntaxError, match=f"nested deeper than {MAX_DEPTH}") as caught:
        parse("(" * 400)

    assert caught.value.column == MAX_DEPTH + 1


def test_the_longest_chain_of_not_is_read() -> None:
    assert parse("not " * 124 + "x") == parse("x")


_WORDS = (
    *("a", "b.state", "part('x/y').mode", "A", "'B c'", "1", "-0.5", "1e3", "[A, 1]", "[]", "x:=1"),
    *("error.E", "true", "hold('h')", "(", ")", "not", "and", "or", "in", "==", "<", ">=", "!="),
    *("(a or b)", "not in", "f'x'", "lambda:", "**", ",", ".", "\x00", "\ud800"),
)


def _read_by_python(node: ast.expr) -> Node | None:
    """Return what Python reads: its text, joined again from the pieces of its own tree."""
    match node:
        case ast.BoolOp():
            word = " and " if isinstance(node.op, ast.And) else " or "
            return parse(word.join(f"({ast.unparse(value)})" for value in node.values))
        case ast.UnaryOp(op=ast.Not()):
            return parse(f"not ({ast.unparse(node.operand)})")
        case _:
            return None


def _read_or_rejected(text: str) -> Node | ConditionSyntaxError:
    try:
        return parse(text)
    except ConditionSyntaxError as error:
        return error


def test_random_text_is_read_as_python_reads_it_or_rejected_with_a_column() -> None:
    rng = random.Random(14)
    count = 0
    for _ in range(20_000):
        text = " ".join(rng.choices(_WORDS, k=rng.randint(1, 9)))
        read = _read_or_rejected(text)
        if isinstance(read, ConditionSyntaxError):
            assert 1 <= read.column <= len(text) + 1
            assert read.message.encode()
            continue
        count += 1
        assert parse(read.text) == read, "what is shown means the same"
        assert _read_by_python(ast.parse(text, mode="eval").body) in (None, read)
    assert count > 500


def test_random_bytes_are_rejected_or_read() -> None:
    rng = random.Random(15)
    for _ in range(20_000):
        text = bytes(rng.choices(range(256), k=rng.randint(0, 12))).decode("latin-1")
        read = _read_or_rejected(text)
        if isinstance(read, ConditionSyntaxError):
            assert 1 <= read.column <= len(text) + 1


def test_a_leaf_knows_where_it_stands() -> None:
    first, second = comparisons(parse("x < 1 or not b.mode in [SLOW, FAST]"))

    assert isinstance(first, Comparison)
    assert (first.subject.column, first.columns) == (1, (5,))
    assert (second.subject.column, second.columns) == (14, (25, 31))
