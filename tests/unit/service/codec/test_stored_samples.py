"""Records as releases wrote them; every later release must read them.

A file holds one record a line, as `tests/support/record_samples` has them in the same order. A
class that gains a field keeps its lines, since the field has a default, and gets a new one. Lines
are never changed.
"""

from pathlib import Path
from typing import Any

import pytest

from domain.actor import Actor
from domain.events.event import Event, RecordedEvent
from service.codec.codec import EVENTS, Codec
from service.codec.names import NAMES
from tests.support.record_samples import events, inputs, messages, others, process_samples
from tests.support.records import RECORDS, is_same

FOLDER = Path(__file__).parents[3] / "data" / "codec" / "v1"
SAMPLES = {
    **inputs.INPUTS,
    **events.EVENTS,
    **messages.MESSAGES,
    **others.OTHERS,
    **process_samples.PROCESSES,
}
CODECS: dict[str, Codec[Any]] = {NAMES[kind]: codec for kind, codec in RECORDS}


def written(value: object) -> bytes:
    """Return a record; an event is written as an entry of the log."""
    if isinstance(value, Event):
        return EVENTS.encode(RecordedEvent(1, 2, None, Actor(), value))
    return CODECS[NAMES[type(value)]].encode(value)


def read(name: str, line: bytes) -> object:
    return CODECS[name].decode(line) if name in CODECS else EVENTS.decode(line).event


def test_every_class_has_samples() -> None:
    assert set(SAMPLES) == set(NAMES.values())
    assert all(NAMES[type(value)] == name for name, values in SAMPLES.items() for value in values)


@pytest.mark.parametrize("name", SAMPLES)
def test_a_stored_record_is_read_as_it_was_meant(name: str) -> None:
    file = FOLDER / f"{name}.jsonl"
    values = SAMPLES[name]
    assert file.exists(), b"\n".join([b"a new file with", *map(written, values)]).decode()

    lines = file.read_bytes().splitlines()

    assert len(lines) == len(values)
    for line, value in zip(lines, values, strict=True):
        assert is_same(read(name, line), value)
