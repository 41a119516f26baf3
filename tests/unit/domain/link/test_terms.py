"""What two computers must agree on."""

from dataclasses import replace

import pytest

from domain.link.messages import Terms
from domain.link.terms import (
    OTHER_MODEL,
    OTHER_OWNERSHIP,
    OTHER_PROTOCOL,
    find_refusal,
)

OURS = Terms(model="m", ownership="o", protocol=1, version="1.2.0")


@pytest.mark.parametrize(
    ("other", "code"),
    [
        (replace(OURS, model="n"), OTHER_MODEL),
        (replace(OURS, ownership="p"), OTHER_OWNERSHIP),
        (replace(OURS, protocol=0), OTHER_PROTOCOL),
    ],
)
def test_what_does_not_fit_is_refused_with_its_code(other: Terms, code: str) -> None:
    refusal = find_refusal(OURS, other)

    assert refusal is not None
    assert refusal.code == code


@pytest.mark.parametrize("other", [OURS, replace(OURS, protocol=2), replace(OURS, version="1.3.0")])
def test_a_newer_computer_fits_since_it_speaks_what_we_speak(other: Terms) -> None:
    assert find_refusal(OURS, other) is None
