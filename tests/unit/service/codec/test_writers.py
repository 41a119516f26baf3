from dataclasses import dataclass

from service.codec.shape import Shape, as_it_is
from service.codec.writers import writer_of


@dataclass(frozen=True)
class Leg:
    """A class of records."""

    name: str
    length_m: float = 0.0
    note: str = ""
    speed_mps: float | None = None


TEXT = Shape((str,), as_it_is)
NUMBER = Shape((float,), as_it_is)
SHAPES = {"name": TEXT, "length_m": NUMBER, "note": TEXT, "speed_mps": NUMBER}


def test_a_default_is_left_out_unless_it_is_a_number() -> None:
    write = writer_of(Leg, SHAPES, {"is": "leg"})

    assert write(Leg("a")) == {"is": "leg", "name": "a", "length_m": 0.0}
    assert write(Leg("a", 1.0, "b", 2.0)) == {
        "is": "leg",
        "name": "a",
        "length_m": 1.0,
        "note": "b",
        "speed_mps": 2.0,
    }


def test_fields_are_written_as_their_shape_says() -> None:
    doubled = Shape((float,), as_it_is, lambda value: 2 * value)
    write = writer_of(Leg, SHAPES | {"length_m": doubled, "speed_mps": doubled}, {})

    assert write(Leg("a", 1.0, speed_mps=3.0)) == {"name": "a", "length_m": 2.0, "speed_mps": 6.0}
