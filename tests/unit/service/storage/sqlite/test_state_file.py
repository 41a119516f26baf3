from pathlib import Path

import pytest

from service.storage.sqlite.schema import BrokenFileError
from service.storage.sqlite.state_file import Applied, StateFile

HOLD, TASK = ("kept_hold", "operator"), ("kept_task", "t1")


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "state.db"


def test_what_is_applied_is_there_when_it_is_opened_again(path: Path) -> None:
    state = StateFile.begin(path, "robot", {HOLD: b"one", TASK: b"task"}, Applied(1, 2))
    state.apply({HOLD: b"two", ("own", "page"): b"1"}, Applied(1, 4))
    state.apply({TASK: None}, Applied(2, 1))
    state.finish()

    state = StateFile.open(path)
    assert state.kept() == {HOLD: b"two", ("own", "page"): b"1"}
    assert state.applied() == Applied(2, 1)
    state.close()
    assert [found.name for found in path.parent.iterdir()] == ["state.db"]


def test_values_come_back_byte_by_byte(path: Path) -> None:
    values = [b"{}", b"null", b'"\\u0000\\n"', "\"Grüße 'n' \U0001f916\"".encode(), b"[1e999,-0.0]"]
    kept = {("own", f"'{number}\"'"): value for number, value in enumerate(values)}
    state = StateFile.begin(path, "robot", {}, Applied(1, 1))

    state.apply({**kept, HOLD: None}, Applied(1, 2))

    assert state.kept() == kept
    state.close()


def test_values_keep_their_order(path: Path) -> None:
    state = StateFile.begin(path, "robot", {TASK: b"1", HOLD: b"2"}, Applied(1, 1))
    state.apply({TASK: b"3"}, Applied(1, 2))

    assert list(state.kept()) == [TASK, HOLD]
    state.close()


def test_the_write_ahead_log_stays_small(path: Path) -> None:
    state = StateFile.begin(path, "robot", {}, Applied(1, 0))
    for number in range(200):
        state.apply({HOLD: b"x" * 3_000}, Applied(1, number))

    assert path.with_name("state.db-wal").stat().st_size < 150 * 4_200
    state.close()


def test_an_empty_file_is_no_state(path: Path) -> None:
    path.touch()

    with pytest.raises(BrokenFileError):
        StateFile.open(path)
