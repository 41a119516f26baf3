from datetime import UTC, datetime, timedelta

from domain.actor import NOBODY
from domain.events.driving import HoldSet
from domain.events.event import RecordedEvent
from domain.identifiers import ChangeId, TaskId
from domain.kept import Keeping, KeptChange
from domain.outbox import Outputs
from service.storage.id_blocks import BOOT, CHANGE, EVENT, TASK, IdBlocks, unreserved


def events_up_to(number: int) -> Outputs:
    return Outputs(events=(RecordedEvent(number, 0, None, NOBODY, HoldSet("a", "")),))


def test_a_run_reserves_a_block_of_each_kind_at_its_start() -> None:
    ids = IdBlocks({EVENT: 101})

    assert ids.reserve() == {EVENT: 10_101, CHANGE: 1_001, TASK: 1_001}
    assert ids.reserve() == {}


def test_the_next_block_is_reserved_while_half_of_the_last_one_is_left() -> None:
    ids = IdBlocks({})
    ids.reserve()

    assert not ids.see(events_up_to(5_000))
    assert ids.see(events_up_to(5_001))
    assert ids.reserve() == {EVENT: 15_002}
    assert not ids.see(events_up_to(5_002))


def test_changes_and_tasks_have_ids_of_their_own() -> None:
    ids = IdBlocks({})
    ids.reserve()

    assert not ids.see(Outputs(change=ChangeId("c12"), task=TaskId("t3")))
    assert ids.see(Outputs(change=ChangeId("c501")))

    assert ids.exact() == {EVENT: 1, CHANGE: 502, TASK: 4}


def test_a_change_that_nobody_requested_uses_an_id_as_well() -> None:
    ids = IdBlocks({})
    ids.reserve()
    ids.see(Outputs(change=ChangeId("c12")))

    ids.see(Outputs(kept=(Keeping(KeptChange, "c13", None),)))

    assert ids.exact()[CHANGE] == 14


def test_a_run_that_ends_says_exactly_what_it_used() -> None:
    ids = IdBlocks({EVENT: 10})
    ids.reserve()
    ids.see(events_up_to(12))
    ids.see(events_up_to(11))

    assert ids.exact()[EVENT] == 13


def test_without_a_disk_to_reserve_on_no_other_run_has_the_same_ids() -> None:
    first = {EVENT: 40, CHANGE: 7, TASK: 2, BOOT: 3}
    start = datetime(2026, 1, 1, tzinfo=UTC)

    ids = unreserved(first, start)
    later = unreserved(first, start + timedelta(seconds=1))

    assert ids[BOOT] == 3
    assert ids[EVENT] == ids[CHANGE] == 189_388_800_000
    assert later[EVENT] == ids[EVENT] + 1_000
    assert unreserved({EVENT: 10**12}, start)[EVENT] == 10**12
