import pytest

from domain.errors import UnknownTaskError
from domain.identifiers import TaskId
from domain.paths.path import Path
from domain.tasks.task import Task
from domain.tasks.task_log import MAX_KEPT, TaskLog
from tests.support.paths import straight


def task(number: int, path: Path | None = None) -> Task:
    return Task(TaskId(f"t{number}"), path or straight(), "stanley", 2.8, 0, number, cause=1)


def test_the_newest_comes_first() -> None:
    log = TaskLog()
    log.add(task(1))
    log.add(task(2))

    assert [kept.id for kept in log.newest_first()] == ["t2", "t1"]


def test_the_oldest_are_forgotten_when_there_are_too_many() -> None:
    log = TaskLog()
    for number in range(MAX_KEPT + 2):
        log.add(task(number))

    assert len(list(log.newest_first())) == MAX_KEPT
    with pytest.raises(UnknownTaskError):
        log.get("t1")
    assert log.get("t2").created_at == 2


def test_long_paths_make_old_tasks_forgotten_earlier(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("domain.tasks.task_log.MAX_KEPT_POINTS", 50)
    log = TaskLog()
    for number in range(3):
        log.add(task(number))

    assert [kept.id for kept in log.newest_first()] == ["t2", "t1"]


def test_the_newest_is_kept_however_long_its_path_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("domain.tasks.task_log.MAX_KEPT_POINTS", 5)
    log = TaskLog()
    log.add(task(1))

    assert log.get("t1").path.count == 21


def test_a_task_that_is_not_there_is_told_with_those_that_are_the_newest_first() -> None:
    log = TaskLog()
    log.add(task(1))
    log.add(task(2))
    with pytest.raises(UnknownTaskError) as unknown:
        log.get("t9")

    assert unknown.value.message == "there is no task 't9'"
    assert unknown.value.hint == "known: t2, t1"


def test_no_more_is_forgotten_than_has_to_be(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("domain.tasks.task_log.MAX_KEPT_POINTS", 42)
    log = TaskLog()
    for number in range(2):
        log.add(task(number))
    assert len(list(log.newest_first())) == 2
    log.add(task(2, straight(40.0)))

    assert [kept.id for kept in log.newest_first()] == ["t2"]


def test_which_tasks_are_dropped_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("domain.tasks.task_log.MAX_KEPT", 2)
    log = TaskLog()

    assert [log.add(task(number)) for number in range(4)] == [[], [], ["t0"], ["t1"]]
