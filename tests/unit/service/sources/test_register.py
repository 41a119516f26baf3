from typing import Any

import pytest

from service.files.source_block import RegisterBlock
from service.sources.register import number_in
from service.sources.source import SourceError


@pytest.mark.parametrize(
    ("data", "settings", "number"),
    [
        (b"\x12\x34", {}, 0x1234),
        (b"\x34\x12", {"order": "little"}, 0x1234),
        (b"\xff", {"size_bytes": 1}, 255),
        (b"\xff", {"size_bytes": 1, "signed": True}, -1),
        # Bus voltage of an INA219: 12 V in steps of 4 mV, above three flags.
        (b"\x5d\xc2", {"shift": 3, "scale": 0.004}, 12.0),
        # LM75 at -25 degrees: 11 bits in two's complement, steps of an eighth.
        (b"\xe7\x1f", {"shift": 5, "signed": True, "scale": 0.125}, -25.0),
        # MCP3008: 10 bits, the bits before them undefined.
        (b"\xfe\x00", {"bits": 10, "scale": 3.3 / 1024}, 1.65),
        (b"\x00\x00\x00\x01", {"size_bytes": 4, "offset": -1.0}, 0.0),
    ],
)
def test_the_bytes_of_a_register_are_a_number(
    data: bytes, settings: dict[str, Any], number: float
) -> None:
    assert number_in(data, RegisterBlock.model_validate(settings)) == pytest.approx(number)


@pytest.mark.parametrize("data", [b"", b"\x01", b"\x01\x02\x03"])
def test_an_answer_of_another_length_is_refused(data: bytes) -> None:
    with pytest.raises(SourceError, match="instead of 2"):
        number_in(data, RegisterBlock())
