"""Control groups, as folders that a test writes."""

import os
from pathlib import Path

import pytest

from service.sources.os.cgroup import Group, root_of_groups
from service.sources.os.rates import Rate

MIB = 1 << 20


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "system.slice" / "ros.service"
    made.mkdir(parents=True)
    (made / "memory.current").write_text(f"{64 * MIB}\n")
    (made / "memory.max").write_text(f"{256 * MIB}\n")
    (made / "memory.events").write_text("low 0\noom 2\noom_kill 1\n")
    (made / "pids.current").write_text("7\n")
    (made / "memory.pressure").write_text("some avg10=3.50 avg60=0.00 avg300=0.00 total=9\n")
    (made / "cpu.stat").write_text("usage_usec 1000000\nuser_usec 1\n")
    return made


@pytest.mark.parametrize(
    ("what", "value"),
    [
        ("memory_bytes", 64 * MIB),
        ("memory_percent", 25.0),
        ("memory_pressure_percent", 3.5),
        ("processes", 7),
        ("oom_kills", 1),
    ],
)
def test_what_the_processes_of_a_group_use(
    folder: Path, tmp_path: Path, what: str, value: float
) -> None:
    assert folder.is_dir()
    assert Group("system.slice/ros.service", tmp_path).reader(what)() == value


def test_without_a_limit_the_share_is_that_of_the_machine(folder: Path, tmp_path: Path) -> None:
    (folder / "memory.max").write_text("max\n")
    total = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")

    share = Group("/system.slice/ros.service", tmp_path).reader("memory_percent")()
    assert share == pytest.approx(100 * 64 * MIB / total)


def test_cpu_is_the_share_of_all_cores_from_look_to_look(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("os.cpu_count", lambda: 4)
    times = iter([0.0, 2.0])
    monkeypatch.setattr("service.sources.os.cgroup.Rate", lambda: Rate(lambda: next(times)))
    read = Group("system.slice/ros.service", tmp_path).reader("cpu_percent")
    assert read() is None

    (folder / "cpu.stat").write_text("usage_usec 5000000\n")
    assert read() == 50.0


def test_a_group_that_is_gone_says_which_file_is_missing(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"memory\.current"):
        Group("gone.service", tmp_path).reader("memory_bytes")()


def test_where_both_versions_are_used_version_2_has_a_folder_of_its_own(tmp_path: Path) -> None:
    assert root_of_groups(tmp_path) == tmp_path
    (tmp_path / "unified").mkdir()
    assert root_of_groups(tmp_path) == tmp_path / "unified"
    (tmp_path / "cgroup.controllers").touch()
    assert root_of_groups(tmp_path) == tmp_path
