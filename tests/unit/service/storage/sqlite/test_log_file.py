from dataclasses import replace
from pathlib import Path
from random import Random

import apsw
import pytest

from domain.state_and_mode import PartName
from domain.timebase import seconds
from service.storage.sqlite.batch import Batch, Checkpoint, Hole
from service.storage.sqlite.connection import reading
from service.storage.sqlite.log_file import LogFile, Next
from tests.support.faulty_disk import FaultyDisk, faulty
from tests.support.log_files import NO_CHANGES, batch, flight, log_file, run


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "000001.db"


def rows(path: Path, sql: str) -> list[tuple[object, ...]]:
    with reading(path) as connection:
        return connection.execute(sql).fetchall()


def changes(file: LogFile, after: int = 0) -> list[tuple[str, str, bytes | None]]:
    return list(file.changes_after(after))


def test_a_new_file_begins_with_the_run_and_with_all_that_is_kept(path: Path) -> None:
    file = log_file(path, Next(step=11, batch=5, event=21))

    assert changes(file) == [("kept_hold", "old", b"old")]
    assert (file.summary.next_step, file.summary.last_batch, file.last_change) == (11, 4, 1)
    file.close()
    boots = rows(path, "SELECT number, epoch, first_batch, first_event, ended_wall_ns FROM boots")
    assert boots == [(1, "epoch-1", 5, 21, None)]


def test_a_flight_is_written_whole(path: Path) -> None:
    file = log_file(path)
    one = batch(1, 1, b"one", b"two", at=100, events=(1, 2))
    one.checkpoints.append(Checkpoint(2, 110, b"state"))
    one.hole = Hole(2, 3, 4, 120, 140, "full")

    file.write(flight(one), run(), {("kept_hold", "new"): b"new", ("kept_hold", "old"): None})

    assert changes(file, 1) == [("kept_hold", "new", b"new"), ("kept_hold", "old", None)]
    assert rows(path, "SELECT number, first_step, count, first_at, last_at FROM batches") == [
        (1, 1, 2, 100, 110)
    ]
    assert rows(path, "SELECT id, kind, actor FROM events") == [
        (1, "hold.set", "ada"),
        (2, "hold.set", "ada"),
    ]
    assert rows(path, "SELECT step, batch, at FROM checkpoints") == [(2, 1, 110)]
    assert rows(path, "SELECT * FROM holes") == [(1, 1, 2, 3, 4, 120, 140, "full")]
    file.close()


TABLES = ("batches", "events", "event_parts", "changes")
AWKWARD = (
    b"{}",
    b'"\\u0000\\n"',
    "\"Grüße 'n' \U0001f916\"".encode(),
    b"[1e999,-0.0]",
    b"null",
    None,
)
"""Kept values as JSON, and what is kept no longer."""


def with_dictionary(path: Path, number: int) -> LogFile:
    file = log_file(path.with_name(f"{number:06}.db"), number=number)
    file.dictionary = b"a step that was written before"
    return file


def random_batch(random: Random, number: int) -> Batch:
    steps = [b"step %d" % random.randrange(99) for _ in range(random.randrange(4))]
    first = 10 * number
    found = batch(number, 100 * number, *steps, at=number, events=(*range(first, first + 2),))
    event = found.events[0]
    words = random.choice(["", 'it\'s "so"', "Grüße\n", "\\"])
    parts = (PartName("left/arm"), PartName("base"))[: random.randrange(3)]
    cause = random.choice([None, 2**62])
    found.events[0] = event._replace(words=words, parts=parts, cause=cause)
    return found


def test_what_is_one_statement_writes_the_same_as_many(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    random = Random(5)
    one, many = with_dictionary(path, 1), with_dictionary(path, 2)
    for number in range(1, 60):
        given = flight(random_batch(random, number))
        values = {
            ("kept_hold", f"'{n}'"): random.choice(AWKWARD) for n in range(random.randrange(4))
        }
        one.write(given, run(), values)
        with monkeypatch.context() as patch:
            patch.setattr(LogFile, "_is_one_statement", lambda *_: False)
            many.write(given, run(), values)

    for table in TABLES:
        sql = f"SELECT * FROM {table}"
        assert rows(one.path, sql) == rows(many.path, sql), table
    assert changes(one)[1:] == changes(many)[1:]
    assert replace(one.summary, path=path, number=0) == replace(many.summary, path=path, number=0)
    one.close()
    many.close()


def test_the_usual_flight_is_one_statement(path: Path) -> None:
    file = with_dictionary(path, 1)
    told: list[str] = []
    file._connection.set_profile(lambda sql, _: told.append(sql))  # noqa: SLF001

    file.write(flight(batch(1, 1, b"one", events=(1, 2))), run(), {("kept_hold", "new"): b"new"})

    assert [sql for sql in told if not sql.startswith("--")] == [told[-1]]
    assert told[-1].startswith("INSERT INTO flights")
    file.close()


def test_one_statement_that_fails_leaves_nothing(path: Path) -> None:
    file = with_dictionary(path, 1)
    before = file.summary
    # The same number twice.
    broken = batch(2, 1, b"one", events=(1,))
    with file._connection as connection:  # noqa: SLF001
        connection.execute("INSERT INTO batches VALUES (2,1,1,0,0,0,0,0,x'',0,0,0)")

    with pytest.raises(apsw.ConstraintError):
        file.write(flight(broken), run(), {("a", "b"): b"c"})

    assert file.summary == before
    assert rows(file.path, "SELECT * FROM events") == changes(file, 1) == []
    file.close()


def test_what_fails_halfway_leaves_nothing(path: Path) -> None:
    file = log_file(path)
    broken = batch(2, 3, b"three", at=200)
    broken.wall_ns = 2**70

    with pytest.raises(OverflowError):
        file.write(flight(batch(1, 1, b"one", events=(1,)), broken), run(), {("a", "b"): b"c"})

    assert file.summary.last_batch == 0
    assert changes(file, 1) == []
    assert rows(path, "SELECT * FROM batches") == rows(path, "SELECT * FROM events") == []
    file.write(flight(batch(1, 1, b"one", events=(1,))), run(), NO_CHANGES)
    assert len(rows(path, "SELECT * FROM events")) == 1
    file.close()


def test_what_was_written_all_the_same_is_not_written_twice(path: Path) -> None:
    file = log_file(path)
    first, second = batch(1, 1, b"one", events=(1,)), batch(2, 2, b"two", events=(2,))
    file.write(flight(first), run(), NO_CHANGES)
    first.hole = Hole(1, 1, 0, 0, 0, "full")

    file.write(flight(first, second), run(), NO_CHANGES)

    assert rows(path, "SELECT number FROM batches") == [(1,), (2,)]
    assert rows(path, "SELECT batch, steps FROM holes") == [(1, 1)]
    file.close()


def test_a_file_goes_on_where_it_ended(path: Path) -> None:
    file = log_file(path)
    file.write(flight(batch(1, 1, b"one", b"two", at=100, events=(1,))), run(), NO_CHANGES)
    before = file.summary
    file.close()

    file = LogFile.open(path, 1)
    file.begin_run(run(2), {("kept_hold", "new"): b"new"}, Next(3, 2, 2))
    assert (file.summary.next_step, file.summary.last_batch) == (3, 1)
    assert file.summary.running_ns == before.running_ns == 10
    assert file.last_change == 2
    file.write(flight(batch(2, 3, b"three", at=5_000, events=(2,))), run(2), NO_CHANGES)
    assert file.summary.running_ns == 10
    file.close()
    assert rows(path, "SELECT boot, id FROM events") == [(1, 1), (2, 2)]


def test_running_time_is_that_of_the_steps(path: Path) -> None:
    file = log_file(path)
    file.write(flight(batch(1, 1, b"one", b"two", at=100)), run(), NO_CHANGES)
    file.write(flight(Batch(2, 3)), run(), NO_CHANGES)
    file.write(flight(batch(3, 3, b"three", at=500)), run(), NO_CHANGES)

    assert file.summary.running_ns == 400
    assert (file.summary.first_wall_ns, file.summary.wall_ns) == (1_000, 3_000)
    file.close()


def test_the_end_of_a_run_is_noted(path: Path) -> None:
    file = log_file(path)
    last = batch(1, 1, b"one")
    last.ends_run = True
    file.write(flight(last), run(), NO_CHANGES)
    file.finish()

    assert rows(path, "SELECT ended_wall_ns FROM boots") == [(1_000,)]
    assert [found.name for found in path.parent.iterdir()] == ["000001.db"]


def test_what_must_last_is_synced_and_the_rest_now_and_then(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = [seconds(100.0)]
    monkeypatch.setattr("time.monotonic_ns", lambda: now[0])
    with faulty(FaultyDisk(path.parent)) as disk:
        file = log_file(path)

        def syncs(must_last: bool) -> int:
            before, number = disk.syncs, file.summary.last_batch + 1
            file.write(flight(batch(number, number, b"step"), must_last=must_last), run(), {})
            return disk.syncs - before

        # The first one also makes the write-ahead log.
        assert syncs(must_last=False) >= 1
        assert syncs(must_last=False) == 0
        assert syncs(must_last=True) == 1
        now[0] += seconds(0.4)
        assert syncs(must_last=False) == 0
        now[0] += seconds(0.2)
        assert syncs(must_last=False) == 1
        file.close()


def test_the_write_ahead_log_is_taken_in_when_it_is_large(path: Path) -> None:
    file = log_file(path)
    noise = [bytes((7 * n * n + k) % 251 for n in range(2_000)) for k in range(2_100)]
    file.write(flight(batch(1, 1, *noise)), run(), NO_CHANGES)
    before = path.stat().st_size
    file.tidy()
    assert file.size() >= path.stat().st_size >= before
    file.close()


def test_steps_are_packed_with_earlier_ones_once_there_are_enough(path: Path) -> None:
    file = log_file(path)
    long = b'{"is":"recorded_step","at":%d}' * 40
    sizes = []
    for number in range(1, 21):
        file.write(flight(batch(number, number, long % ((number,) * 40))), run(), NO_CHANGES)
        sizes.append(file.summary.step_bytes)
    assert file.dictionary
    file.close()

    packed = [bool(row[0]) for row in rows(path, "SELECT packed FROM batches ORDER BY number")]
    assert packed == sorted(packed)
    assert (packed[0], packed[-1]) == (False, True)
    assert sizes[-1] - sizes[-2] < sizes[0]
    again = LogFile.open(path, 1)
    assert again.dictionary == file.dictionary
    again.close()
