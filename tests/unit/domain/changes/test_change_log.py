import pytest

from domain.changes.change_log import KEPT_CHANGES, PACKED_AT_ONCE, ChangeLog
from domain.changes.plan import NodeGoal
from domain.changes.record import Change
from domain.errors import UnknownChangeError
from domain.identifiers import ChangeId
from domain.inputs import ModeRequest
from domain.snapshot import ChangeStatus
from domain.state_and_mode import PartName
from tests.support.models import BASE, FAST


def _change(log: ChangeLog, status: ChangeStatus = ChangeStatus.SUCCEEDED) -> Change:
    change = Change(log.next_id(), BASE, ModeRequest(BASE, FAST), {}, 0, 1, status=status)
    log.add(change)
    log.forget_old()
    return change


def test_changes_are_numbered_and_go_on_where_an_earlier_run_ended() -> None:
    log = ChangeLog()
    assert log.next_id() == "c1"
    log.count_from(8)
    assert log.next_id() == "c8"


def test_the_newest_come_first_and_the_oldest_are_forgotten() -> None:
    log = ChangeLog()
    changes = [_change(log) for _ in range(KEPT_CHANGES + 1)]
    assert log.all()[0] is changes[-1]
    assert len(log.all()) == KEPT_CHANGES
    with pytest.raises(UnknownChangeError):
        log.get("c1")


def test_a_change_that_runs_or_waits_is_not_forgotten() -> None:
    log = ChangeLog()
    waiting = _change(log, ChangeStatus.WAITING)
    for _ in range(KEPT_CHANGES + 1):
        _change(log)
    assert log.get(waiting.id) is waiting


def test_a_change_of_many_nodes_is_packed_later() -> None:
    log = ChangeLog()
    few, many = _change(log), _change(log)
    nodes = [PartName(f"n{number}") for number in range(PACKED_AT_ONCE + 1)]
    many.set_out(dict.fromkeys(nodes, NodeGoal(None)))
    many.open.clear()
    for change in (few, many):
        log.pack(change)
    assert few.packed is not None
    assert (many.packed, log.has_more) == (None, True)
    log.pack_next()
    assert many.packed is not None
    assert log[ChangeId("c2")] is many
