from pathlib import Path

import apsw
import pytest

from service.storage.id_blocks import BOOT, CHANGE, EVENT, TASK
from service.storage.sqlite.log_file import Next
from service.storage.sqlite.looking import Left, is_fault_of_file, look, look_at_copy
from service.storage.sqlite.places import Places
from service.storage.sqlite.schema import BrokenFileError
from tests.support.folder_robot import ENOUGH_S, started


@pytest.fixture
def places(tmp_path: Path) -> Places:
    return Places(tmp_path / "robot")


def test_in_a_new_folder_everything_counts_from_one(places: Places) -> None:
    places.make()

    left = look(places, "robot")

    assert left.is_new
    assert left.next_ids() == {EVENT: 1, CHANGE: 1, TASK: 1, BOOT: 1}
    assert left.next_numbers(1) == Next(1, 1, 1)
    assert left.newest is None


async def test_a_copy_says_the_same_and_changes_nothing(places: Places) -> None:
    robot = await started(places.folder)
    robot.holds("operator")
    await robot.journal.commit(ENOUGH_S)
    before = places.state.read_bytes()

    left = look_at_copy(places, "robot")

    assert ("kept_hold", "operator") in left.kept
    assert left.next_ids()[EVENT] == 10_001
    assert left.newest is not None
    assert left.newest.last_event == 1
    assert (left.state, left.log) == (None, None)
    assert places.state.read_bytes() == before
    await robot.journal.close()


def test_with_a_broken_file_ids_go_on_far_beyond_what_is_known() -> None:
    left = Left(kept={("ids", "event"): b"77", ("ids", "boot"): b"5"})
    assert left.next_ids()[EVENT] == 77

    left.broken[Path("state.db")] = "it is empty"

    assert left.next_ids() == {EVENT: 1_000_077, CHANGE: 100_001, TASK: 100_001, BOOT: 5}


def io_error(code: int) -> Exception:
    error: Exception = apsw.exception_for(code)
    return error


@pytest.mark.parametrize(
    ("error", "is_broken"),
    [
        (apsw.NotADBError(), True),
        (apsw.CorruptError(), True),
        (BrokenFileError(), True),
        (io_error(apsw.SQLITE_IOERR_READ), True),
        (io_error(apsw.SQLITE_IOERR_SHORT_READ), True),
        (io_error(apsw.SQLITE_IOERR_WRITE), False),
        (apsw.FullError(), False),
        (apsw.ReadOnlyError(), False),
        (apsw.CantOpenError(), False),
        (OSError(), False),
    ],
)
def test_a_file_is_to_blame_for_what_it_holds_and_not_for_the_disk(
    error: Exception, is_broken: bool
) -> None:
    assert is_fault_of_file(error) is is_broken
