"""A recording that is played, on a clock that a test moves."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from api.replaying.player import Player
from api.replaying.recording import Recording, recording_of
from domain.errors import PilothouseError
from domain.timebase import seconds
from service.recorded_pieces import offset_of
from service.replayed_robot import ReplayedRobot
from service.storage.errors import UnusableFolderError
from tests.support.manual_clock import ManualClock
from tests.support.recorded_robot import RecordedRobot
from tests.support.stored_robot import boot_of, held_on_its_way, store

VERSION = boot_of(1).version
BEGIN = boot_of(1).started_at + offset_of(boot_of(1))


class BrokenError(PilothouseError):
    """A record that is broken."""

    code = "INTERNAL"


@pytest.fixture(scope="module")
def robot() -> RecordedRobot:
    return held_on_its_way()


@pytest.fixture(scope="module")
def recording(robot: RecordedRobot, tmp_path_factory: pytest.TempPathFactory) -> Recording:
    folder = tmp_path_factory.mktemp("data") / "robot"
    store(folder, robot, checkpoints=(20, 60))
    return recording_of(folder, VERSION, None, None)


@asynccontextmanager
async def playing(player: Player) -> AsyncIterator[None]:
    run = asyncio.create_task(player.run())
    try:
        yield
    finally:
        run.cancel()
        await asyncio.wait([run])


def shown_s(player: Player) -> float:
    """Return the moment that is shown, in s since the begin."""
    return (player.wall - BEGIN) / seconds(1)


def test_a_recording_knows_its_robot_and_its_extent(
    recording: Recording, robot: RecordedRobot
) -> None:
    assert recording.robot == "robot"
    assert recording.begin == BEGIN
    assert recording.end >= robot.taken[-1].at + offset_of(boot_of(1))


@pytest.mark.parametrize("speed", [0.1, 1.0, 10.0])
async def test_it_is_played_at_its_speed_with_20_frames_a_second(
    recording: Recording, speed: float
) -> None:
    clock = ManualClock()
    player = Player(recording, VERSION, clock, speed)
    frames = player.robot.supervisor.frames
    async with playing(player):
        await clock.advance(0.25)

    assert shown_s(player) == pytest.approx(0.25 * speed, abs=0.001)
    assert frames.newest is not None
    # Six ticks; a change of the system state is published in between, too.
    assert frames.newest.at - boot_of(1).started_at == pytest.approx(
        seconds(0.25 * speed), abs=seconds(0.001)
    )


async def test_at_its_end_it_stands_and_shows_the_last_state(
    recording: Recording, robot: RecordedRobot
) -> None:
    clock = ManualClock()
    player = Player(recording, VERSION, clock, 100)
    async with playing(player):
        await clock.advance(2)

    assert player.wall == recording.end
    assert player.fault is None
    assert player.robot.supervisor.events.newest == robot.events[-1].id


async def test_while_it_is_paused_frames_come_and_time_stands(recording: Recording) -> None:
    clock = ManualClock()
    player = Player(recording, VERSION, clock)
    async with playing(player):
        await clock.advance(1)
        player.is_paused = True
        wall, seq = player.wall, player.robot.supervisor.publisher.seq
        await clock.advance(1)
        assert player.wall == wall
        assert player.robot.supervisor.publisher.seq == seq + 20
        player.is_paused = False
        await clock.advance(1)

    assert player.wall - wall == pytest.approx(seconds(1), abs=seconds(0.06))


async def test_it_goes_back_to_an_earlier_moment_with_another_robot(
    recording: Recording, robot: RecordedRobot
) -> None:
    clock = ManualClock()
    player = Player(recording, VERSION, clock, 100)
    told: list[ReplayedRobot] = []
    player.on_robot = told.append
    async with playing(player):
        await clock.advance(1)
        player.is_paused = True
        before = player.robot
        asked = asyncio.create_task(player.seek(BEGIN + seconds(2)))
        await clock.advance(0.1)
        await asked

        assert told == [player.robot]
        assert player.robot is not before
        assert shown_s(player) == pytest.approx(2, abs=0.001)
        assert "gate" in player.robot.supervisor.core.driving.holds


@pytest.mark.parametrize("by_s", [-100, 100])
async def test_a_moment_outside_is_the_nearest_one_inside(recording: Recording, by_s: int) -> None:
    clock = ManualClock()
    player = Player(recording, VERSION, clock)
    player.is_paused = True
    async with playing(player):
        asked = asyncio.create_task(player.seek(BEGIN + seconds(by_s)))
        await clock.advance(0.1)
        await asked

    assert player.wall == (recording.begin if by_s < 0 else recording.end)


@pytest.fixture
def two_runs(robot: RecordedRobot, tmp_path: Path) -> Recording:
    again = RecordedRobot(boot_of(2), robot.kept())
    again.advance(1)
    store(tmp_path / "robot", robot, again)
    return recording_of(tmp_path / "robot", VERSION, None, None)


async def test_the_next_run_follows_without_the_time_between(two_runs: Recording) -> None:
    clock = ManualClock()
    player = Player(two_runs, VERSION, clock, 100)
    epochs = [player.robot.supervisor.epoch]
    player.on_robot = lambda robot: epochs.append(robot.supervisor.epoch)
    async with playing(player):
        await clock.advance(2)

    assert epochs == ["run-1", "run-2"]
    assert "restart" in player.robot.supervisor.core.driving.holds


def test_events_are_its_begin_and_its_end(robot: RecordedRobot, tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    store(folder, robot)
    held = next(event for event in robot.events if event.kind == "hold.set")
    released = next(event for event in robot.events if event.kind == "hold.released")

    found = recording_of(folder, VERSION, held.id, released.id)

    offset = offset_of(boot_of(1))
    assert found.begin == held.at + offset - seconds(1)
    assert found.end == released.at + offset


@pytest.mark.parametrize(
    ("failure", "words"),
    [
        (BrokenError("something else came"), "something else came"),
        (OSError(5, "Input/output error"), "Input/output error"),
        (UnusableFolderError("the folder no longer holds that"), "the folder no longer holds that"),
    ],
)
async def test_where_the_record_does_not_lead_on_it_stands_and_says_why(
    recording: Recording, monkeypatch: pytest.MonkeyPatch, failure: Exception, words: str
) -> None:
    clock = ManualClock()
    player = Player(recording, VERSION, clock)
    async with playing(player):
        await clock.advance(1)

        def fail(robot: ReplayedRobot, end: int) -> None:
            raise failure

        monkeypatch.setattr(ReplayedRobot, "advance_to", fail)
        await clock.advance(1)

        assert player.fault == words
        monkeypatch.undo()
        asked = asyncio.create_task(player.seek(BEGIN))
        await clock.advance(0.1)
        await asked

    assert player.fault is None
