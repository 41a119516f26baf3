import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.storage.kind_pattern import KindPattern


@pytest.mark.parametrize(
    ("text", "kind", "expected"),
    [
        ("change.failed", "change.failed", True),
        ("change", "change.failed", True),
        ("chang", "change.failed", False),
        ("change.", "change.failed", False),
        ("chang*", "change.failed", True),
        ("*.failed", "change.failed", True),
        ("*.failed", "change.failed_twice", False),
        ("*", "change.failed", True),
        ("c*e*d", "change.failed", True),
        ("*change*", "change.failed", True),
        ("change.failed*failed", "change.failed", False),
        ("*.*.*", "change.failed", False),
        ("", "change.failed", False),
        ("**", "change.failed", True),
        ("change", "change.requested", True),
        ("change", "change", True),
        ("change", "changes.requested", False),
        ("change.requested", "change.requested", True),
        ("change.*", "change.requested", True),
        ("*.requested", "change.requested", True),
        ("*", "anything", True),
        ("c*d", "change.requested", True),
        ("c*d", "change.request", False),
        ("chang.", "change", False),
        ("[a-z]*", "change", False),
    ],
)
def test_a_pattern_means_these_kinds(text: str, kind: str, *, expected: bool) -> None:
    assert KindPattern(text).matches(kind) is expected


@given(
    text=st.text("ab.*", max_size=8).filter(lambda text: "*" in text),
    kind=st.text("ab.", max_size=10),
)
def test_stars_stand_for_any_characters(text: str, kind: str) -> None:
    plain = re.compile(".*".join(re.escape(piece) for piece in text.split("*")))

    assert KindPattern(text).matches(kind) == bool(plain.fullmatch(kind))


def test_a_hostile_pattern_is_decided_at_once() -> None:
    assert not KindPattern("*a" * 49 + "*b").matches("a" * 100)
