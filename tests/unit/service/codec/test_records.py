from dataclasses import dataclass
from typing import Literal

import pytest

from domain.actor import Actor
from domain.inputs import TimePassed
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
