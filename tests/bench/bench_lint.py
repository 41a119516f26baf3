"""How long lint of a large model takes, with guards, an order and a fallback in every part."""

import time

import pytest

from service.files.model_file import check_model
from tests.support.bench import report
from tests.support.big_model import big_model_text
from tests.support.guarded_model_text import guarded_model_text

pytestmark = pytest.mark.bench

SIZES = (100, 1_000, 10_000)
ROUNDS = 3


def test_a_model_of_a_thousand_nodes_is_checked_in_seconds() -> None:
    rows = {}
    for nodes in SIZES:
        plain, guarded = big_model_text(nodes), guarded_model_text(nodes)
        rows[f"{nodes:,} nodes"] = {
            "plain_s": round(min(_seconds_to_check(plain) for _ in range(ROUNDS)), 3),
            "guarded_s": round(min(_seconds_to_check(guarded) for _ in range(ROUNDS)), 3),
            "guarded_megabytes": round(len(guarded) / 1e6, 2),
        }

    report(
        "lint",
        "Lint of a model",
        "From YAML to all findings; `guarded`: each part has three conditions, and each system an "
        f"order. Best of {ROUNDS}.",
        rows,
        asked="1,000 nodes in less than 5 s.",
    )
    assert rows["1,000 nodes"]["guarded_s"] < 5


def _seconds_to_check(text: str) -> float:
    start = time.perf_counter()
    assert check_model(text) == ()
    return time.perf_counter() - start
