import shutil
from pathlib import Path

import apsw
import pytest

from domain.state_and_mode import PartName
from service.codec.codec import STEPS
from service.storage.journal import EventQuery
from service.storage.sqlite import schema
from service.storage.sqlite.connection import open_to_write
from service.storage.sqlite.log_file import LogFile
from service.storage.sqlite.recorded_log import RecordedLog
from service.storage.sqlite.schema import (
    LOG,
    STATE,
    BrokenFileError,
    NewerFileError,
    NoSpaceError,
    bring_up,
    describe,
    examine,
    version_of,
)
from tests.support.folder_robot import found_in, holds

STORED = Path(__file__).resolve().parents[4] / "data" / "store"
"""A folder that each version left: two runs, both ended."""

FIRST = "CREATE TABLE meta (name TEXT PRIMARY KEY, value); CREATE TABLE entries (text TEXT)"
SECOND = "ALTER TABLE entries ADD COLUMN author TEXT NOT NULL DEFAULT 'nobody'"
THIRD = "CREATE INDEX entries_by_author ON entries (author)"


@pytest.fixture
def old(tmp_path: Path) -> Path:
    """Return a file that has been through the first step."""
    path = tmp_path / "a.db"
    connection = open_to_write(path)
    bring_up(connection, path, (FIRST,))
    describe(connection, robot="robot")
    connection.execute("INSERT INTO entries VALUES ('kept')")
    connection.close()
    return path


@pytest.mark.parametrize("version", [path.name for path in sorted(STORED.iterdir())])
async def test_what_each_version_left_is_still_there(tmp_path: Path, version: str) -> None:
    folder = tmp_path / "robot"
    shutil.copytree(STORED / version, folder)

    found = await found_in(folder, 3)

    assert found.restored.stop_because == ""
    assert found.left_out == ()
    assert holds(found) == {"planner": "no route"}
    assert found.own == {"simulation": {"pose": [1.0, 2.5, 0.0]}}
    assert found.epochs == {"epoch-1": 3, "epoch-2": 8}
    assert (found.restored.boot, found.restored.next_event) == (3, 9)
    log = RecordedLog(folder)
    assert [run.number for run in log.runs()] == [1, 2, 3]
    assert [STEPS.decode(line).at for _, line in log.lines(1)] == [50000000, 100000000, 150000000]
    first, _ = log.checkpoints()
    assert log.state(first) == b"state of run 1"
    arm = log.events(EventQuery(part=PartName("left/arm"), limit=10))
    assert [event.kind for event in arm] == ["change.requested", "change.step_started"] * 2


def test_the_current_version_has_a_stored_folder() -> None:
    assert (STORED / f"v{len(LOG)}" / "log" / "000001.db").is_file()
    assert (STORED / f"v{len(STATE)}" / "state.db").is_file()


def test_a_file_goes_through_the_steps_that_it_lacks(old: Path) -> None:
    connection = open_to_write(old)

    bring_up(connection, old, (FIRST, SECOND, THIRD))

    assert version_of(connection) == 3
    assert connection.execute("SELECT * FROM entries").fetchall() == [("kept", "nobody")]
    connection.close()


def test_a_file_goes_through_all_steps_or_none(old: Path) -> None:
    connection = open_to_write(old)

    with pytest.raises(apsw.SQLError):
        bring_up(connection, old, (FIRST, SECOND, "CREATE TABLE entries (text TEXT)"))

    assert version_of(connection) == 1
    assert connection.execute("SELECT * FROM entries").fetchall() == [("kept",)]
    connection.close()


def test_without_enough_room_a_file_stays_as_it_is(
    old: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(schema, "_SPARE_BYTES", 2**60)
    connection = open_to_write(old)

    with pytest.raises(NoSpaceError, match=r"a\.db needs \d+ bytes to be migrated"):
        bring_up(connection, old, (FIRST, SECOND))

    assert version_of(connection) == 1
    bring_up(connection, old, (FIRST,))
    connection.close()


def test_a_file_of_this_version_is_left_as_it_is(old: Path) -> None:
    before = old.read_bytes()

    examine(old, (FIRST,))

    assert old.read_bytes() == before


def test_a_later_version_is_known(old: Path) -> None:
    connection = open_to_write(old)
    connection.pragma("user_version", 7)
    connection.close()

    with pytest.raises(NewerFileError, match="version 7 of the file; this release knows 1"):
        examine(old, (FIRST,))


def test_records_of_a_later_version_are_known(old: Path) -> None:
    connection = open_to_write(old)
    connection.execute("UPDATE meta SET value = 7 WHERE name = 'records'")
    connection.close()

    with pytest.raises(NewerFileError, match="records of version 7; this release knows"):
        examine(old, (FIRST,))


def test_an_empty_file_is_broken(tmp_path: Path) -> None:
    (tmp_path / "a.db").touch()

    with pytest.raises(BrokenFileError, match="it is empty"):
        examine(tmp_path / "a.db", (FIRST,))


def test_files_are_marked_as_ours(tmp_path: Path) -> None:
    marks = {path.read_bytes()[68:72] for path in STORED.rglob("*.db")}

    assert marks == {b"PILT"}


def test_a_log_of_a_later_version_is_not_opened(tmp_path: Path) -> None:
    path = tmp_path / "000001.db"
    shutil.copy(STORED / "v1" / "log" / "000001.db", path)
    connection = apsw.Connection(str(path))
    connection.pragma("user_version", len(LOG) + 1)
    connection.close()

    with pytest.raises(NewerFileError):
        LogFile.open(path, 1)
