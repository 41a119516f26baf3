import json
import math
from enum import StrEnum

import numpy as np
import pytest

from domain.paths.path import Path
from service.codec.codec import INPUTS
from service.codec.errors import CodecError
from service.codec.shapes import PATH, PLAIN, of_enum, of_mapping, of_tuple
from tests.support.records import is_same


class Gear(StrEnum):
    """An enumeration of the core."""

    FORWARD = "forward"
    REVERSE = "reverse"


def test_a_path_is_the_same_to_the_last_bit() -> None:
    rng = np.random.default_rng(7)
    rows = np.cumsum(rng.normal(size=(1000, 3)), axis=0)
    path = Path(np.add(rows, (4e5, 5.5e6, 0.0)))
    assert PATH.write is not None

    read = PATH.read(PATH.write(path))

    assert is_same(read, path)
    assert read.length_m == path.length_m
    assert read.project(4e5, 5.5e6, 400) == path.project(4e5, 5.5e6, 400)


@pytest.mark.parametrize(
    ("waypoints", "message"),
    [
        ("?", "not waypoints in base64"),
        ("AAAA", "not waypoints in base64"),
        ("", "2 to 100000 waypoints, not 0"),
        ("A" * 64, "all waypoints are at the same position"),
        ("//////////8" * 8, ""),
    ],
)
def test_waypoints_that_are_no_path_are_rejected(waypoints: str, message: str) -> None:
    task = {"is": "task_request", "path": waypoints, "start_index": 1}
    text = json.dumps(task | {"controller": "stanley", "speed_mps": 1.0}).encode()

    with pytest.raises(CodecError, match=f"path: .*{message}"):
        INPUTS.decode(text)


def test_an_integer_stays_one_where_a_number_is_expected() -> None:
    assert is_same(PLAIN[float].read(3), 3)
    assert is_same(PLAIN[float].read(3.0), 3.0)


def test_a_number_that_json_does_not_have_is_an_object() -> None:
    assert math.isnan(PLAIN[float].read({"float": "nan"}))
    with pytest.raises(CodecError, match="expected a number, or"):
        PLAIN[float].read({"float": "nan", "double": "nan"})


def test_a_member_of_an_enumeration_is_its_text() -> None:
    assert of_enum(Gear).read("reverse") is Gear.REVERSE
    with pytest.raises(CodecError, match="'up' is none of forward, reverse"):
        of_enum(Gear).read("up")


def test_an_error_in_a_list_or_an_object_says_where() -> None:
    with pytest.raises(CodecError, match=r"^\[1\]: expected a text, not null$"):
        of_tuple(PLAIN[str]).read(["a", None])
    with pytest.raises(CodecError, match=r"^gain: expected a text, not an integer$"):
        of_mapping(PLAIN[str]).read({"gain": 1})
