import re

from service.codec.names import NAMES
from tests.support.records import EVENT_CLASSES, RECORDS


def test_every_class_has_a_name_of_its_own() -> None:
    classes = {kind for kind, _ in RECORDS} | set(EVENT_CLASSES)

    assert set(NAMES) == classes
    assert len(set(NAMES.values())) == len(NAMES)


def test_names_are_in_snake_case_and_events_are_named_as_clients_know_them() -> None:
    for kind, name in NAMES.items():
        assert re.fullmatch(r"[a-z]+(_[a-z]+)*(\.[a-z]+(_[a-z]+)*)?", name)
        assert ("." in name) == (kind in EVENT_CLASSES)
