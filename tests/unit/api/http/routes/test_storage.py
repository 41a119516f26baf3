"""`/storage` and the warnings of a store that fails, as an operator sees them."""

from datetime import UTC, datetime

import pytest

from service.storage.journal import LogStatus, StorageStatus
from service.storage.memory import MemoryJournal
from service.storage.trends.trends import Trends, TrendsStatus
from tests.support.http_robot import HttpRobot

NOON = datetime(2026, 1, 1, 12, tzinfo=UTC)
FULL = StorageStatus(
    "/var/lib/pilothouse/gem_e2",
    7_000_000,
    0,
    "the disk is full",
    "3.54.1",
    12,
    {"inputs": LogStatus(NOON, None, 5), "events": LogStatus(None, None, 0)},
    lost_inputs=30,
    lost_events=2,
)


class FullDisk(MemoryJournal):
    """A journal whose disk is full."""

    def status(self) -> StorageStatus:
        return FULL


@pytest.fixture
def _full(robot: HttpRobot) -> None:
    robot.supervisor.journal = FullDisk.__new__(FullDisk)


async def test_a_robot_that_keeps_nothing_says_so(robot: HttpRobot) -> None:
    shown = await robot.get("/storage")

    assert (shown["path"], shown["degraded"], shown["reason"]) == (":memory:", False, None)


@pytest.mark.usefixtures("_full")
async def test_a_full_disk_is_shown_with_what_is_lost(robot: HttpRobot) -> None:
    shown = await robot.get("/storage")

    assert shown == {
        "path": "/var/lib/pilothouse/gem_e2",
        "bytes": 7_000_000,
        "free_bytes": 0,
        "degraded": True,
        "reason": "the disk is full",
        "library_version": "3.54.1",
        "boot": 12,
        "logs": {
            "inputs": {"from_at": "2026-01-01T12:00:00.000Z", "to_at": None, "bytes": 5},
            "events": {"from_at": None, "to_at": None, "bytes": 0},
        },
        "lost_inputs": 30,
        "lost_events": 2,
        "history": {"bytes": 0, "lost_readings": 0, "reason": None},
    }


async def test_the_history_of_the_signals_is_shown_beside_the_logs(
    robot: HttpRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken_file = TrendsStatus(5_000, 7, "disk I/O error")
    monkeypatch.setattr(Trends, "status", broken_file)

    shown = await robot.get("/storage")

    broken = {"bytes": 5_000, "lost_readings": 7, "reason": "disk I/O error"}
    assert shown["history"] == broken


@pytest.mark.usefixtures("_full")
async def test_a_full_disk_is_a_warning_of_the_service_and_a_metric(robot: HttpRobot) -> None:
    health = await robot.get("/healthz")
    metrics = (await robot.http.get("/metrics")).text

    assert health["status"] == "ok"
    assert [item for item in health["warnings"] if item["code"] == "STORAGE_DEGRADED"] == [
        {
            "code": "STORAGE_DEGRADED",
            "message": "the disk is full; a restart may forget what is asked now",
        }
    ]
    assert "pilothouse_storage_degraded 1.0" in metrics
    assert 'pilothouse_storage_lost_total{log="inputs"} 30.0' in metrics
