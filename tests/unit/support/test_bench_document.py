from typing import Any

from tests.support.bench_document import document, renewed


def _result(**other: object) -> dict[str, Any]:
    return {
        "title": "Inference",
        "how": "One report after the other.",
        "asked": "0.1 ms.",
        "notes": ["Without node."],
        "command": "make bench ARGS=tests/bench/bench_inference.py",
        "measured_at": "2026-11-24T18:00+00:00",
        "machine": {"CPU": "one", "cores": "2"},
        "rows": {"ours": {"p50_ms": 0.25}, "theirs": {"p50_ms": 3, "lost": 250_000}},
        **other,
    }


def test_a_result_becomes_a_section_that_says_what_was_measured_how_and_with_which_command() -> (
    None
):
    text = document([_result()])

    assert "## Inference\n\nOne report after the other.\n\nRequired: 0.1 ms.\n" in text
    assert "Without node.\n\n`make bench ARGS=tests/bench/bench_inference.py`" in text
    assert "2026-11-24 18:00 UTC" in text


def test_the_table_has_all_columns_with_their_units_and_leaves_open_what_is_not_known() -> None:
    text = document([_result()])

    assert (
        "| | p50, ms | lost |\n|---|---:|---:|\n| ours | 0.25 |  |\n| theirs | 3 | 250,000 |\n"
        in text
    )


def test_yes_and_no_are_words() -> None:
    text = document([_result(rows={"a lap": {"done": True, "late": False}})])

    assert "| a lap | yes | no |" in text


def test_one_machine_is_named_once() -> None:
    text = document([_result(), _result(title="Start")])

    assert text.count("Machine: CPU: one; cores: 2.") == 1


def test_several_machines_are_named_at_each_result() -> None:
    other = {"CPU": "two", "cores": "8"}

    text = document([_result(), _result(title="Start", machine=other)])

    assert "two" not in text.partition("## Inference")[2].partition("## Start")[0]
    assert "Machine: CPU: two; cores: 8." in text.partition("## Start")[2]


def test_without_a_bound_none_is_named() -> None:
    assert "Required:" not in document([_result(asked="")])


def test_a_bench_that_was_run_by_itself_renews_its_section_and_leaves_the_others() -> None:
    before = document([_result(), _result(title="Start"), _result(title="Stop")])
    newer = document([_result(title="Start", how="Twice."), _result(title="Robot")])

    text = renewed(before, newer)

    assert text == document(
        [
            _result(),
            _result(title="Start", how="Twice."),
            _result(title="Stop"),
            _result(title="Robot"),
        ]
    )
