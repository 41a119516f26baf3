"""The event loop appends readings; the thread takes them all at once."""

import pytest

from service.storage.trends import intake
from service.storage.trends.intake import Intake
from service.storage.trends.rows import NO_ERROR, row_count


def test_readings_are_taken_once_in_their_order() -> None:
    taking = Intake()
    taking.add(3, 1_000, 1.5, NO_ERROR)
    taking.add(0, 2_000, True, 7)

    taking.add(3, 3_000, 2.5, NO_ERROR)

    rows = taking.take()

    assert {signal: own.first.tolist() for signal, own in rows.items()} == {
        3: [1_000, 3_000],
        0: [2_000],
    }
    assert (rows[3].final.tolist(), rows[3].error.tolist()) == ([1.5, 2.5], [NO_ERROR, NO_ERROR])
    assert (rows[0].final.tolist(), rows[0].error.tolist()) == ([1.0], [7])
    assert not taking.take()


def test_while_nobody_takes_them_they_are_bounded_and_counted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(intake, "MOST", 3)
    taking = Intake()

    for number in range(5):
        taking.add(0, number, 0.0, NO_ERROR)

    assert taking.dropped == 2
    assert row_count(taking.take()) == 3

    taking.add(0, 9, 0.0, NO_ERROR)

    assert taking.dropped == 2
