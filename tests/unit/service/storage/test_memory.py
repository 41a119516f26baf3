from service.storage import memory
from service.storage.journal import EventQuery
from service.storage.memory import MemoryJournal, MemoryStore
from tests.support.manual_clock import ManualClock
from tests.support.noted_robot import NotedRobot, boot


def journal(store: MemoryStore | None = None) -> MemoryJournal:
    return MemoryJournal(boot(1), ManualClock(), store)


async def test_the_oldest_events_go_when_memory_is_full() -> None:
    robot = NotedRobot(journal())
    for _ in range(memory.DEFAULT_CAPACITY + 5):
        robot.holds("operator")

    events = await robot.journal.events(EventQuery(after=0, limit=1))

    assert [event.id for event in events] == [6]


async def test_nothing_is_left_without_a_store() -> None:
    first = journal()
    NotedRobot(first).holds("operator")
    await first.close()

    assert journal().found.is_new


async def test_the_status_says_that_it_is_memory() -> None:
    status = journal().status()

    assert status.path == ":memory:"
    assert status.free_bytes is None
    assert status.logs["events"].from_at is None


async def test_no_state_is_wanted_from_which_nothing_is_replayed() -> None:
    kept = journal()
    kept.checkpoint(0, 0, b"state")

    assert not kept.wants_checkpoint
