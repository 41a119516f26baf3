import stat
from pathlib import Path

import apsw
import pytest

from service.storage.sqlite.connection import (
    finish,
    library_version,
    new_file,
    open_to_write,
    reading,
    remove,
    words,
)


def made(path: Path) -> Path:
    with new_file(path) as connection:
        connection.execute("CREATE TABLE entries (text TEXT)")
        connection.execute("INSERT INTO entries VALUES ('first')")
    return path


def entries(path: Path) -> list[str]:
    with reading(path) as connection:
        return [str(row[0]) for row in connection.execute("SELECT text FROM entries")]


def test_the_library_is_newer_than_the_race_of_two_connections() -> None:
    assert tuple(map(int, library_version().split("."))) >= (3, 51, 3)


def test_a_file_is_written_without_maps_and_with_a_sync_for_each_commit(tmp_path: Path) -> None:
    connection = open_to_write(made(tmp_path / "a.db"))

    assert connection.pragma("mmap_size") in (0, None)
    assert connection.pragma("journal_mode") == "wal"
    assert connection.pragma("synchronous") == 2
    assert connection.pragma("locking_mode") == "normal"
    connection.close()


def test_a_new_file_appears_when_it_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "a.db"

    def fail() -> None:
        with new_file(path) as connection:
            connection.execute("CREATE TABLE entries (text TEXT)")
            raise OSError("no more")

    with pytest.raises(OSError, match="no more"):
        fail()

    assert not path.exists()
    assert entries(made(path)) == ["first"]
    assert [found.name for found in tmp_path.iterdir()] == ["a.db"]
    assert stat.S_IMODE(path.stat().st_mode) == 0o600


def test_whoever_reads_cannot_write(tmp_path: Path) -> None:
    made(tmp_path / "a.db")

    with reading(tmp_path / "a.db") as connection, pytest.raises(apsw.ReadOnlyError):
        connection.execute("DELETE FROM entries")


def test_a_file_is_read_while_it_is_written(tmp_path: Path) -> None:
    path = made(tmp_path / "a.db")
    connection = open_to_write(path)
    connection.execute("INSERT INTO entries VALUES ('second')")

    assert entries(path) == ["first", "second"]
    connection.close()


def test_a_file_is_read_as_a_kill_left_it(tmp_path: Path) -> None:
    path = made(tmp_path / "a.db")
    connection = open_to_write(path)
    connection.execute("INSERT INTO entries VALUES ('second')")
    left = tmp_path / "left.db"
    left.write_bytes(path.read_bytes())
    (tmp_path / "left.db-wal").write_bytes((tmp_path / "a.db-wal").read_bytes())
    connection.close()

    assert entries(left) == ["first", "second"]


def test_what_is_not_there_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        entries(tmp_path / "a.db")


def test_a_finished_file_stands_alone(tmp_path: Path) -> None:
    connection = open_to_write(made(tmp_path / "a.db"))
    connection.execute("INSERT INTO entries VALUES ('second')")

    finish(connection)

    assert [found.name for found in tmp_path.iterdir()] == ["a.db"]
    assert entries(tmp_path / "a.db") == ["first", "second"]


def test_nothing_is_lost_if_a_reader_keeps_a_file_from_being_finished(tmp_path: Path) -> None:
    path = made(tmp_path / "a.db")
    connection = open_to_write(path)
    connection.set_busy_timeout(0)
    connection.execute("INSERT INTO entries VALUES ('second')")
    with reading(path) as reader:
        rows = reader.execute("SELECT text FROM entries")
        next(rows)
        finish(connection)
        assert [row[0] for row in rows] == ["second"]

    assert entries(path) == ["first", "second"]


def test_a_file_is_removed_with_what_is_beside_it(tmp_path: Path) -> None:
    connection = open_to_write(made(tmp_path / "a.db"))
    connection.execute("INSERT INTO entries VALUES ('second')")

    remove(tmp_path / "a.db")
    connection.close()
    remove(tmp_path / "a.db")

    assert list(tmp_path.iterdir()) == []


def test_what_failed_is_said_in_words() -> None:
    assert words(OSError(28, "No space left on device")) == "No space left on device"
    assert words(ValueError("wrong")) == "wrong"
    assert words(ValueError()) == "ValueError"
    assert words(apsw.FullError("database or disk is full")) == "database or disk is full"
    error = apsw.exception_for(apsw.SQLITE_IOERR_FSYNC)
    error.args = ("disk I/O error",)
    assert words(error) == "disk I/O error (SQLITE_IOERR_FSYNC)"
