import zlib

import pytest

from service.storage.sqlite.packing import DICTIONARY_BYTES, DictionaryMaker, pack, unpack


def step(number: int) -> bytes:
    return b'{"is":"recorded_step","at":%d,"given":{"is":"time_passed"},"is_late":false}' % number


@pytest.mark.parametrize("dictionary", [b"", step(0) * 100])
@pytest.mark.parametrize("count", [0, 1, 3, 1_000])
def test_steps_are_unpacked_as_they_were_packed(count: int, dictionary: bytes) -> None:
    steps = [step(number) for number in range(count)]

    assert unpack(pack(steps, dictionary), dictionary) == steps


def test_a_single_step_is_small_beside_earlier_ones() -> None:
    earlier = b"\n".join(step(number) for number in range(100))

    assert len(pack([step(1_000)], earlier)) < len(pack([step(1_000)], b"")) / 2


def test_with_another_dictionary_nothing_is_read() -> None:
    with pytest.raises(zlib.error):
        unpack(pack([step(1)], step(0) * 100), step(9) * 99)


def test_a_dictionary_is_made_of_the_first_steps_once_there_are_enough() -> None:
    maker = DictionaryMaker()
    seen = 0
    while not (dictionary := maker.see([step(seen)])):
        seen += 1

    assert len(dictionary) == DICTIONARY_BYTES
    assert dictionary.endswith(step(seen))
