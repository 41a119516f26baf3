from dataclasses import dataclass
from typing import Literal

import pytest

from domain.actor import Actor
from domain.findings import Blocker
from domain.inputs import TimePassed
from service.codec.json_text import from_text, to_text
from service.codec.records import Shapes


@dataclass(frozen=True)
class Unnamed:
    """A new class of the core that has no name for records yet."""


def test_a_class_without_a_name_cannot_be_a_record() -> None:
    with pytest.raises(TypeError, match="Unnamed has no name for records"):
        Shapes().of_named((TimePassed, Unnamed))


@pytest.mark.parametrize("hint", [object, set[int], Literal["a"], tuple[int, int], dict[str, int]])
def test_a_type_that_records_do_not_know_is_told_at_once(hint: object) -> None:
    with pytest.raises(TypeError, match="no record can hold"):
        Shapes().of(hint)


@pytest.mark.parametrize(
    ("hint", "message"),
    [(str | Actor | None, None), (Actor | TimePassed, None), (float | Actor, "an object does not")],
)
def test_a_union_needs_members_that_json_tells_apart(hint: object, message: str | None) -> None:
    if message is None:
        Shapes().of(hint)
        return
    with pytest.raises(TypeError, match=message):
        Shapes().of(hint)


def test_a_tree_is_written_and_read_to_its_leaves() -> None:
    leaf = Blocker("UNKNOWN_VALUE", "gps was never seen", ("gps",), condition="gps < 1")
    root = Blocker("CONDITION", "not met", (), causes=(leaf, leaf), condition="gps < 1 and x")
    shape = Shapes().of(Blocker)
    assert shape.write is not None

    assert shape.read(from_text(to_text(shape.write(root)), 1000)) == root


def test_a_leaf_of_an_earlier_release_had_no_causes() -> None:
    old = {"code": "ESTOP", "message": "pressed", "path": [], "value": True, "root_cause": True}

    blocker = Shapes().of(Blocker).read(old)

    assert (blocker.causes, blocker.condition) == ((), None)
