"""`GET /frames`: how the robot was, asked hours and restarts later."""

import asyncio
from pathlib import Path
from typing import Any

import pytest

from api.streaming import frame_jobs
from domain.actor import Actor
from domain.errors import StorageDegradedError
from domain.inputs import HoldRequest
from domain.outbox import NOTHING
from service.storage.journal import Step
from service.storage.sqlite.recorded_log import RecordedLog
from service.worker import WorkerBusyError
from tests.support.going_client import EndlessWork, GoingClient
from tests.support.http_robot import HttpRobot, http_scope
from tests.support.manual_clock import ManualClock
from tests.support.stored_service import StoredService, later, stored_service


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "robot"


def robot_in(frame: dict[str, Any]) -> dict[str, Any]:
    """Return what a frame says of the robot: all but its own number."""
    state = dict(frame["system_state"])
    assert frame["seq"] == state.pop("seq") == 1
    return {**frame, "system_state": state}


async def story(robot: StoredService) -> dict[str, dict[str, Any]]:
    """Let something happen; return the complete frame of each moment that matters."""
    seen: dict[str, dict[str, Any]] = {}
    await robot.clock.advance(1)
    await robot.ask("POST", "/systems/actuation/mode", mode="MODERATE")
    seen[robot.now] = robot.frame()
    await robot.clock.advance(3)
    seen[robot.now] = robot.frame()
    points = [{"x_m": x, "y_m": 0, "yaw_rad": 0} for x in range(20)]
    await robot.ask("POST", "/tasks", waypoints=points, speed_mps=1)
    await robot.clock.advance(4)
    seen[robot.now] = robot.frame()
    await robot.ask("PUT", "/emergency_stop", engaged=True, reason="a child on the track")
    seen[robot.now] = robot.frame()
    return seen


async def test_a_frame_of_earlier_is_what_the_stream_showed_then(folder: Path) -> None:
    async with stored_service(folder, ManualClock()) as robot:
        seen = await story(robot)
        await robot.clock.advance(5)

        for moment, live in seen.items():
            answer = await robot.frame_at(moment)
            assert answer.status_code == 200, answer.text
            assert answer.json()["at"] == moment
            assert robot_in(answer.json()) == robot_in(live)


async def test_the_time_of_an_event_shows_what_it_led_to(folder: Path) -> None:
    async with stored_service(folder, ManualClock()) as robot:
        await story(robot)
        events = (await robot.http.get("/events", params={"kind": "emergency_stop.*"})).json()
        (engaged,) = [e for e in events["items"] if e["kind"].endswith("engaged")]

        shown = (await robot.frame_at(engaged["at"])).json()
        before = (await robot.frame_at(later(engaged["at"], -0.001))).json()

    assert shown["emergency_stop"]["engaged"]
    assert not before["emergency_stop"]["engaged"]


async def test_the_runs_before_a_restart_can_be_looked_at(folder: Path) -> None:
    clock = ManualClock()
    async with stored_service(folder, clock) as robot:
        seen = await story(robot)
    await clock.advance(60)
    async with stored_service(folder, clock, in_process=False) as robot:
        await clock.advance(1)
        here, live = robot.now, robot.frame()

        for moment, then in seen.items():
            assert robot_in((await robot.frame_at(moment)).json()) == robot_in(then)
        assert robot_in((await robot.frame_at(here)).json()) == robot_in(live)


async def test_a_moment_between_two_runs_is_not_there_and_the_extent_is_told(
    folder: Path,
) -> None:
    clock = ManualClock()
    async with stored_service(folder, clock) as robot:
        begin = robot.now
        await clock.advance(1)
        end = robot.now
    await clock.advance(60)
    async with stored_service(folder, clock) as robot:
        await clock.advance(1)
        assert await committed(robot)
        for moment in (later(end, 30), later(begin, -60), later(robot.now, 1)):
            answer = await robot.frame_at(moment)

            assert (answer.status_code, answer.json()["code"]) == (404, "MOMENT_NOT_RECORDED")
            assert f"the record goes from {begin} to {robot.now}" in answer.json()["detail"]


async def test_what_was_lost_is_said_to_be_lost_and_what_follows_is_known_again(
    folder: Path,
) -> None:
    async with stored_service(folder, ManualClock()) as robot:
        journal = robot.supervisor.journal
        assert journal is not None
        await robot.clock.advance(1.01)
        before, seen_before = robot.now, robot.frame()
        await robot.clock.advance(0.1)
        # What cannot be encoded cannot be written down.
        broken = HoldRequest("operator", "half of a letter: \ud83d", Actor("ada"))
        journal.note(Step(robot.clock.now(), broken, False, NOTHING))
        lost = robot.now
        await committed(robot)
        await robot.clock.advance(1)
        await committed(robot)
        await robot.clock.advance(1)
        after, seen_after = robot.now, robot.frame()

        assert len(RecordedLog(folder).holes()) == 1
        assert robot_in((await robot.frame_at(before)).json()) == robot_in(seen_before)
        answer = await robot.frame_at(lost)
        assert (answer.status_code, answer.json()["code"]) == (404, "MOMENT_NOT_RECORDED")
        assert "that was lost: " in answer.json()["detail"]
        assert robot_in((await robot.frame_at(after)).json()) == robot_in(seen_after)


async def committed(robot: StoredService) -> bool:
    assert robot.supervisor.journal is not None
    return await robot.supervisor.journal.commit(5)


@pytest.mark.parametrize("moment", ["", "yesterday", "2026-01-01T00:00:00", "12:00", None])
async def test_a_time_that_is_none_is_rejected(robot: HttpRobot, moment: str | None) -> None:
    answer = await robot.http.get("/frames", params={"at": moment} if moment is not None else {})

    assert (answer.status_code, answer.json()["code"]) == (422, "INVALID_QUERY")


@pytest.mark.parametrize(
    "moment", ["0001-01-01T00:00:00Z", "9999-12-31T23:59:59.999999Z", "2026-01-01T00:00:00-23:59"]
)
async def test_times_at_the_ends_of_the_calendar_are_not_recorded(
    folder: Path, moment: str
) -> None:
    async with stored_service(folder, ManualClock()) as robot:
        answer = await robot.frame_at(moment)

    assert answer.status_code == 404


async def test_a_service_that_keeps_nothing_says_how_it_would(robot: HttpRobot) -> None:
    answer = await robot.http.get("/frames", params={"at": "2026-01-01T00:00:00Z"})

    assert (answer.status_code, answer.json()["code"]) == (404, "MOMENT_NOT_RECORDED")
    assert answer.json()["hint"] == "start it with --data DIR"


async def test_a_log_that_cannot_be_read_is_a_degraded_storage(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with stored_service(folder, ManualClock()) as robot:
        await robot.clock.advance(1)

        def fail(_: Path) -> RecordedLog:
            raise OSError(5, "Input/output error")

        monkeypatch.setattr(frame_jobs, "RecordedLog", fail)
        answer = await robot.frame_at(robot.now)

    assert (answer.status_code, answer.json()["code"]) == (503, "STORAGE_DEGRADED")
    assert "Input/output error" in answer.json()["detail"]


async def test_while_storage_fails_what_is_on_disk_can_be_replayed_and_the_rest_cannot(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with stored_service(folder, ManualClock()) as robot:
        await robot.clock.advance(1)
        written, seen = robot.now, robot.frame()
        assert await committed(robot)

        async def fail(patience_s: float) -> bool:
            raise StorageDegradedError("the disk is full")

        monkeypatch.setattr(robot.supervisor.journal, "commit", fail)
        monkeypatch.setattr(robot.supervisor.journal, "note", lambda _: None)
        await robot.clock.advance(1)
        answer = await robot.frame_at(robot.now)

        assert (answer.status_code, answer.json()["code"]) == (503, "STORAGE_DEGRADED")
        assert "the record of that moment cannot be read: the disk is full" in answer.text
        assert robot_in((await robot.frame_at(written)).json()) == robot_in(seen)
        assert (await robot.frame_at(later(robot.now, 60))).status_code == 404


async def test_whoever_asks_for_too_many_at_once_is_told_to_wait(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with stored_service(folder, ManualClock()) as robot:

        def refuse() -> None:
            raise WorkerBusyError

        monkeypatch.setattr(robot.app.state.replayer, "require_room", refuse)
        answer = await robot.frame_at(robot.now)

    assert (answer.status_code, answer.headers["retry-after"]) == (429, "2")


async def test_a_frame_is_given_up_when_its_client_disconnects(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with stored_service(folder, ManualClock()) as robot:
        client, work = GoingClient(), EndlessWork()
        monkeypatch.setattr(robot.app.state.replayer, "call", work.do)
        scope = http_scope("GET", "/frames", f"at={robot.now}", host="127.0.0.1:8000")
        request = asyncio.create_task(robot.app(scope, client.receive, client.send))
        async with asyncio.timeout(10):
            while not work.is_given_up:
                client.gone.set()
                await asyncio.sleep(0.01)
            await request
