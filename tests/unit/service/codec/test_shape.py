"""JSON of the wrong type is refused before it is read."""

import pytest

from service.codec.errors import CodecError
from service.codec.shape import Shape, as_it_is, unexpected


def test_json_of_the_right_type_is_read() -> None:
    double = Shape((int,), lambda plain: 2 * plain).checked()

    assert double(21) == 42


@pytest.mark.parametrize("read", [as_it_is, lambda plain: plain])
def test_json_of_another_type_never_reaches_the_reader(read: object) -> None:
    check = Shape((int, float), read).checked()  # type: ignore[arg-type]

    with pytest.raises(CodecError, match="expected an integer or a number, not a text"):
        check("5")


def test_true_is_no_integer() -> None:
    with pytest.raises(CodecError, match="expected an integer, not true or false"):
        Shape((int,), as_it_is).checked()(True)


def test_two_types_of_one_name_are_named_once() -> None:
    assert unexpected((int, int), None).message == "expected an integer, not null"
