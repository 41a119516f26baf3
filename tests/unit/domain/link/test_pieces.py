from dataclasses import replace

import pytest

from domain.computers import Incarnation, Session
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.link.messages import Report
from domain.link.pieces import MAX_PIECES, Pieces, cut
from domain.state_and_mode import PartName
from tests.support.linked_pair import ARM

ITEMS = tuple(
    NodeReport(PartName(f"n{number}"), LifecycleState.ACTIVE, reachable=True) for number in range(7)
)
REPORT = Report(ARM, Incarnation("1" * 32), 5, ITEMS, complete=True, session=Session("2" * 32))


def told(*messages: Report) -> list[tuple[int, ...] | None]:
    """Return after each message the numbers of the nodes of the report that is whole by it."""
    pieces = Pieces()
    wholes = [pieces.add(message) for message in messages]
    return [
        None if whole is None else tuple(ITEMS.index(item) for item in whole.items)
        for whole in wholes
    ]


@pytest.mark.parametrize("count", [2, 3, 7])
def test_pieces_hold_all_items_in_their_order(count: int) -> None:
    pieces = list(cut(REPORT, count))

    assert tuple(item for piece in pieces for item in piece.items) == ITEMS
    assert [(piece.piece, piece.pieces) for piece in pieces] == [
        (number, count) for number in range(1, count + 1)
    ]
    assert not any(piece.complete for piece in pieces), "who knows no pieces takes none for all"


@pytest.mark.parametrize("complete", [True, False])
def test_a_report_is_whole_with_its_last_piece(complete: bool) -> None:
    report = replace(REPORT, complete=complete)
    together = Pieces()

    first, second, third = (together.add(piece) for piece in cut(report, 3))

    assert (first, second) == (None, None)
    assert third == replace(report, complete_together=complete)


def test_a_report_that_was_not_cut_is_whole() -> None:
    assert told(REPORT) == [tuple(range(7))]


def test_a_report_of_which_a_piece_is_missing_is_dropped() -> None:
    first, _, third = cut(REPORT, 3)

    assert told(first, third, REPORT) == [None, None, tuple(range(7))]


def test_pieces_of_two_reports_are_never_mixed() -> None:
    first, _ = cut(REPORT, 2)
    _, second = cut(replace(REPORT, seq=6), 2)
    _, of_other_session = cut(replace(REPORT, session=Session("3" * 32)), 2)

    assert told(first, second) == [None, None]
    assert told(first, of_other_session) == [None, None]


def test_a_report_begins_anew_with_its_first_piece() -> None:
    first, second = cut(REPORT, 2)

    assert told(first, first, second) == [None, None, tuple(range(7))]


def test_another_report_ends_the_wait_for_pieces() -> None:
    first, second = cut(REPORT, 2)
    change = replace(REPORT, seq=6, items=ITEMS[:1], complete=False)

    assert told(first, change, second) == [None, (0,), None]


@pytest.mark.parametrize(
    "wrong",
    [
        {"piece": 0, "pieces": 2},
        {"piece": 3, "pieces": 2},
        {"piece": 1, "pieces": 0},
        {"piece": 1, "pieces": MAX_PIECES + 1},
    ],
)
def test_what_cannot_be_a_piece_is_dropped(wrong: dict[str, int]) -> None:
    assert Pieces().add(replace(REPORT, **wrong)) is None  # type: ignore[arg-type]
