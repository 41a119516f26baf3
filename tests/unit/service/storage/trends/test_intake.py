"""The event loop appends readings; the thread takes them all at once."""

import pytest

from service.storage.trends import intake
from service.storage.trends.intake import Intake
from service.storage.trends.rows import NO_ERROR


def test_readings_are_taken_once_in_their_order() -> None:
    taking = Intake()
    taking.add(3, 1_000, 1.5, NO_ERROR)
    taking.add(0, 2_000, True, 7)

    rows = taking.take()

    assert rows is not None
    assert (rows.signal.tolist(), rows.first.tolist()) == ([3, 0], [1_000, 2_000])
    assert (rows.final.tolist(), rows.error.tolist()) == ([1.5, 1.0], [NO_ERROR, 7])
    assert taking.take() is None


def test_while_nobody_takes_them_they_are_bounded_and_counted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(intake, "MOST", 3)
    taking = Intake()

    for number in range(5):
        taking.add(0, number, 0.0, NO_ERROR)

    assert taking.dropped == 2
    assert len(taking.take() or ()) == 3
