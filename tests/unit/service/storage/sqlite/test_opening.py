import os
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import apsw
import pytest

from domain.kept import KeptEmergencyStop
from service.storage.errors import FolderInUseError, ForeignFolderError, UnusableFolderError
from service.storage.journal import Found
from service.storage.sqlite.folder import Retention
from service.storage.sqlite.recorded_log import RecordedLog
from service.storage.sqlite.state_file import StateFile
from tests.support.folder_robot import (
    ENOUGH_S,
    as_a_kill_leaves,
    found_in,
    holds,
    spoil,
    started,
)
from tests.support.waiting import until

PROJECT = Path(__file__).resolve().parents[5]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "robot"


async def lived_in(folder: Path, retention: Retention | None = None, runs: int = 1) -> Path:
    """Let runs set a hold each and end, and return the folder."""
    for run in range(1, runs + 1):
        robot = await started(folder, run, retention or Retention())
        robot.holds(f"operator {run}")
        robot.changes("actuation", "FAST")
        await robot.journal.close()
    return folder


def newer(path: Path) -> None:
    connection = apsw.Connection(str(path))
    connection.execute("PRAGMA user_version=999")
    connection.close()


def holds_newer_records(path: Path) -> None:
    connection = apsw.Connection(str(path))
    connection.execute("UPDATE meta SET value = 999 WHERE name = 'records'")
    connection.close()


def emptied(path: Path) -> None:
    path.write_bytes(b"")


def no_database(path: Path) -> None:
    path.write_text("Dear diary," * 1_000)


def half_lost(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def spoilt_inside(path: Path) -> None:
    spoil(path, 4_096)


DAMAGES = [newer, holds_newer_records, emptied, no_database, half_lost, spoilt_inside]


def named(folder: Path, pattern: str) -> list[Path]:
    """Return files below a folder."""
    return sorted(folder.rglob(pattern))


def modes(folder: Path) -> dict[str, int]:
    """Return who may do what with a folder and all that is in it."""
    paths = [folder, *folder.rglob("*")]
    return {path.name: stat.S_IMODE(path.stat().st_mode) for path in paths}


def contents(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in named(folder, "*.db*")}


def words_by_another_process(path: Path) -> str:
    """Return the words of all events of a file, read by another library."""
    program = (
        "import sys, sqlite3;"
        "c = sqlite3.connect(f'file:{sys.argv[1]}?mode=ro', uri=True);"
        "print(c.execute('SELECT words FROM events').fetchall())"
    )
    command = [sys.executable, "-c", program, str(path)]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def is_stopped(found: Found) -> bool:
    """Tell whether the emergency stop is engaged among what is kept."""
    kept = [value for value in found.restored.kept if isinstance(value, KeptEmergencyStop)]
    return [value.engaged for value in kept] == [True]


@pytest.mark.parametrize("damage", DAMAGES)
async def test_a_broken_state_is_put_aside_and_the_robot_is_stopped(
    folder: Path, damage: Callable[[Path], None]
) -> None:
    await lived_in(folder)
    damage(folder / "state.db")
    damaged = (folder / "state.db").read_bytes()

    found = await found_in(folder, 2)

    assert found.restored.stop_because.startswith("state.db cannot be used: ")
    # The log has all of it as well.
    assert set(holds(found)) == {"operator 1"}
    assert found.restored.next_event > 3
    (aside,) = named(folder, "state.db.broken-*")
    assert aside.read_bytes() == damaged
    following = await found_in(folder, 3)
    assert following.restored.stop_because == ""
    assert is_stopped(following)


@pytest.mark.parametrize("damage", DAMAGES)
async def test_a_broken_log_is_put_aside_and_the_robot_is_stopped(
    folder: Path, damage: Callable[[Path], None]
) -> None:
    await lived_in(folder)
    damage(folder / "log" / "000001.db")

    found = await found_in(folder, 2)

    assert found.restored.stop_because.startswith("000001.db cannot be used: ")
    assert set(holds(found)) == {"operator 1"}
    assert found.restored.boot == 2
    # What the log reserved is unknown now.
    assert found.restored.next_event > 10_000
    assert len(named(folder, "000001.db.broken-*")) == 1
    assert is_stopped(await found_in(folder, 3))


@pytest.mark.parametrize("damage", DAMAGES)
async def test_with_nothing_left_that_is_whole_the_robot_is_stopped(
    folder: Path, damage: Callable[[Path], None]
) -> None:
    await lived_in(folder)
    damage(folder / "state.db")
    damage(folder / "log" / "000001.db")

    found = await found_in(folder, 2)

    assert "state.db cannot be used: " in found.restored.stop_because
    assert "000001.db cannot be used: " in found.restored.stop_because
    assert holds(found) == {}
    assert not found.is_new
    assert is_stopped(await found_in(folder, 3))


async def test_a_broken_older_log_stops_the_robot_and_loses_nothing_else(folder: Path) -> None:
    await lived_in(folder, Retention(file_bytes=1), runs=3)
    no_database(folder / "log" / "000001.db")

    found = await found_in(folder, 4)

    assert "000001.db cannot be used: " in found.restored.stop_because
    assert len(holds(found)) == 3
    assert (await found_in(folder, 5)).restored.stop_because == ""


async def test_the_stop_is_on_disk_before_anything_is_moved(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    await lived_in(folder)
    no_database(folder / "state.db")

    def die(path: Path) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("service.storage.sqlite.folder._move_aside", die)
        with pytest.raises(KeyboardInterrupt):
            await found_in(folder, 2)

    found = await found_in(folder, 3)
    assert is_stopped(found)
    assert found.restored.stop_because != ""


async def test_a_lost_state_is_made_again_from_the_log(folder: Path) -> None:
    await lived_in(folder, runs=2)
    (folder / "state.db").unlink()

    found = await found_in(folder, 3)

    assert found.restored.stop_because == ""
    assert set(holds(found)) == {"operator 1", "operator 2"}
    assert (found.restored.boot, found.restored.next_event) == (3, 7)


async def test_a_lost_log_leaves_what_is_kept(folder: Path) -> None:
    await lived_in(folder, runs=2)
    (folder / "log" / "000001.db").unlink()

    found = await found_in(folder, 3)

    assert set(holds(found)) == {"operator 1", "operator 2"}
    assert (found.restored.boot, found.restored.next_event) == (3, 7)


async def test_a_state_that_lags_behind_is_rolled_forward(folder: Path) -> None:
    await lived_in(folder)
    old = (folder / "state.db").read_bytes()
    robot = await started(folder, 2)
    robot.holds("planner")
    robot.releases("operator 1")
    await robot.journal.close()
    (folder / "state.db").write_bytes(old)

    for run in (3, 4):
        assert set(holds(await found_in(folder, run))) == {"planner"}
        # The state itself was brought up, too.
        state = StateFile.open(folder / "state.db")
        assert {name for kind, name in state.kept() if kind == "kept_hold"} == {"planner"}
        state.finish()


async def test_a_state_ahead_of_the_log_is_not_believed(folder: Path) -> None:
    await lived_in(folder)
    log = folder / "log" / "000001.db"
    old = log.read_bytes()
    robot = await started(folder, 2)
    robot.holds("planner")
    await robot.journal.close()
    log.write_bytes(old)

    for run in (3, 4):
        assert set(holds(await found_in(folder, run))) == {"operator 1"}


async def test_after_a_kill_reserved_ids_are_skipped(folder: Path) -> None:
    robot = await started(folder)
    robot.holds("operator")
    robot.changes("actuation", "FAST")
    await robot.journal.commit(ENOUGH_S)
    robot.holds("planner")

    found = await found_in(as_a_kill_leaves(folder), 2)

    assert set(holds(found)) == {"operator"}
    assert found.epochs == {"epoch-1": 3}
    assert found.restored.next_event == 10_001
    assert found.restored.next_change == 1_001
    await robot.journal.close()


async def test_what_cannot_be_read_back_is_told_and_stays(folder: Path) -> None:
    await lived_in(folder)
    for path in (folder / "state.db", folder / "log" / "000001.db"):
        connection = apsw.Connection(str(path))
        table = "current" if path.name == "state.db" else "changes"
        row = ("kept_arming", "lidar", b'{"is":"kept_arming","by":"ada"}')
        connection.execute(f"INSERT INTO {table} (kind, name, value) VALUES (?,?,?)", row)
        connection.close()

    for run in (2, 3):
        found = await found_in(folder, run)
        assert set(holds(found)) == {"operator 1"}
        assert found.left_out == (
            "kept_arming 'lidar': unknown kind of record 'kept_arming'; did you mean kept_target?",
        )
        assert found.restored.stop_because == ""


async def test_the_folder_of_another_robot_is_left_alone(folder: Path) -> None:
    await lived_in(folder)
    before = contents(folder)

    with pytest.raises(ForeignFolderError, match="belongs to the robot 'robot'"):
        await started(folder, robot="other")

    assert contents(folder) == before
    assert set(holds(await found_in(folder, 2))) == {"operator 1"}


async def test_the_folder_of_another_robot_is_known_by_its_log_as_well(folder: Path) -> None:
    await lived_in(folder)
    no_database(folder / "state.db")

    with pytest.raises(ForeignFolderError):
        await started(folder, robot="other")


async def test_two_services_cannot_share_a_folder(folder: Path) -> None:
    robot = await started(folder)
    robot.holds("operator")

    with pytest.raises(FolderInUseError, match=f"in use by process {os.getpid()}"):
        await started(folder, 2)

    await robot.journal.close()
    assert set(holds(await found_in(folder, 2))) == {"operator"}


async def test_a_folder_that_cannot_be_made_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")

    with pytest.raises(UnusableFolderError, match="Not a directory"):
        await started(tmp_path / "file" / "robot")


async def test_nobody_else_can_read_the_folder(folder: Path) -> None:
    robot = await started(folder)
    robot.holds("operator")
    # The state follows a commit; when the next one is through, it has.
    await robot.journal.commit(ENOUGH_S)
    await robot.journal.commit(ENOUGH_S)

    await until(lambda: "state.db-wal" in modes(folder))
    found = modes(folder)
    await robot.journal.close()

    assert found["state.db-wal"] == found["000001.db-wal"] == 0o600
    assert {name for name, mode in found.items() if mode == 0o700} == {"robot", "log"}
    assert set(found.values()) == {0o600, 0o700}


async def test_another_process_reads_while_the_service_runs(folder: Path) -> None:
    robot = await started(folder)
    robot.holds("operator")
    await robot.journal.commit(ENOUGH_S)
    words = words_by_another_process(folder / "log" / "000001.db")

    assert words == "[('hold operator set: lunch',)]\n"
    robot.holds("planner")
    assert await robot.journal.commit(ENOUGH_S)
    await robot.journal.close()


async def test_a_folder_at_rest_is_plain_files(folder: Path) -> None:
    await lived_in(folder, Retention(file_bytes=1), runs=2)

    names = [path.name for path in named(folder, "*.db*")]

    assert names == ["000001.db", "000002.db", "000003.db", "state.db"]
    assert len(RecordedLog(folder).runs()) == 2
