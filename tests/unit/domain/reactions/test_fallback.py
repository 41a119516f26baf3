"""A fallback as what replaces the target of its part."""

from domain.reactions.fallback import Fallback
from tests.support.models import ACTUATION, MODERATE, active

FALLBACK = Fallback(ACTUATION, MODERATE)


def test_it_leads_to_its_mode() -> None:
    assert FALLBACK.new_target == active(MODERATE)


def test_after_a_restart_it_says_what_it_knows() -> None:
    why = FALLBACK.cause(7)
    assert (why.code, why.path, why.since, why.refuses) == ("INVARIANT", (ACTUATION,), 7, False)
    assert why.message == "actuation could not stay in its mode: an invariant was broken"


def test_it_is_the_same_whenever_it_is_made() -> None:
    assert {FALLBACK, Fallback(ACTUATION, MODERATE)} == {FALLBACK}
