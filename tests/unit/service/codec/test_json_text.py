import json
import math

import pytest

from service.codec.errors import CodecError
from service.codec.json_text import Json, from_text, to_text

LONG = "NaN" * 40_000


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ({"a": (1, 2.0, None, True)}, b'{"a":[1,2.0,null,true]}'),
        ([math.nan, {"b": -math.inf}], b'[{"float":"nan"},{"b":{"float":"-inf"}}]'),
        (["NaN", "Infinity"], b'["NaN","Infinity"]'),
        ([LONG, math.inf], b'["%s",{"float":"inf"}]' % LONG.encode()),
        ("tür", '"tür"'.encode()),
    ],
)
def test_the_text_is_strict_json(value: Json, text: bytes) -> None:
    assert to_text(value) == text
    json.loads(text, parse_constant=pytest.fail)


@pytest.mark.parametrize("value", ["\ud800", object(), {1: object()}])
def test_what_json_does_not_have_cannot_be_written(value: Json) -> None:
    with pytest.raises(CodecError, match="cannot be written as JSON"):
        to_text(value)


@pytest.mark.parametrize("text", [b"", b"NaN", b"[" * 1000, b"9" * 5000, b"\xff", b"1 2", b"{]"])
def test_what_is_no_json_is_rejected(text: bytes) -> None:
    with pytest.raises(CodecError, match="not JSON"):
        from_text(text, 10_000)


def test_a_text_that_is_too_long_is_not_read() -> None:
    assert from_text(b"[0]", 3) == [0]
    with pytest.raises(CodecError, match="at most 2 bytes, not 3"):
        from_text(b"[0]", 2)
