"""How long a model takes from YAML to a checked and linted model."""

import time

import pytest

from service.files.model_file import read_model
from tests.support.bench import report
from tests.support.big_model import big_model_text

pytestmark = pytest.mark.bench

SIZES = (100, 1_000, 10_000)
ROUNDS = 5


def test_a_model_of_ten_thousand_nodes_is_read_in_seconds() -> None:
    rows = {}
    for nodes in SIZES:
        text = big_model_text(nodes)
        times = [_seconds_to_read(text) for _ in range(ROUNDS)]
        rows[f"{nodes:,} nodes"] = {
            "megabytes": round(len(text) / 1e6, 2),
            "best_s": round(min(times), 3),
            "median_s": round(sorted(times)[ROUNDS // 2], 3),
        }

    report(
        "model_file",
        "Reading a model",
        f"From YAML to a checked and linted model, {ROUNDS} times.",
        rows,
        asked="10,000 nodes in less than 3 s.",
    )
    assert rows["10,000 nodes"]["best_s"] < 3


def _seconds_to_read(text: str) -> float:
    start = time.perf_counter()
    read_model(text)
    return time.perf_counter() - start
