"""A recorded robot that is looked at again."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path

import pytest

from domain.actor import NOBODY
from domain.inputs import EmergencyStopRequest, HoldRequest
from domain.onboard import Onboard
from service.clock import to_datetime
from service.recorded_pieces import MomentNotRecordedError, Piece, offset_of, piece_at, pieces_of
from service.replayed_robot import RecordingError, ReplayDiffersError, ReplayedRobot
from service.storage.sqlite.recorded_log import RecordedHole, RecordedLog
from tests.support.recorded_robot import RecordedRobot
from tests.support.stored_robot import boot_of, held_on_its_way, store

VERSION = boot_of(1).version
CHECKPOINTS = (20, 60)


@pytest.fixture(scope="module")
def robot() -> RecordedRobot:
    return held_on_its_way()


@pytest.fixture(scope="module")
def folder(robot: RecordedRobot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the data of a robot with checkpoints on its way."""
    folder = tmp_path_factory.mktemp("data") / "robot"
    store(folder, robot, checkpoints=CHECKPOINTS)
    return folder


@pytest.fixture
def replayed(folder: Path) -> ReplayedRobot:
    return ReplayedRobot(next(pieces_of(RecordedLog(folder), VERSION, None, None)), VERSION)


def seen_of(core: Onboard) -> Sequence[object]:
    """Return what can be seen of a core."""
    shown = core.core
    driving = shown.driving
    return (
        shown.system_state(),
        dict(shown.parts()),
        dict(shown.signals()),
        driving.vehicle,
        driving.latest_task,
        dict(driving.holds),
        shown.emergency_stop(),
    )


def test_at_its_end_it_shows_what_the_robot_showed(
    replayed: ReplayedRobot, robot: RecordedRobot
) -> None:
    replayed.advance_to(robot.now)

    assert seen_of(replayed.supervisor._onboard) == seen_of(robot.onboard)  # noqa: SLF001
    assert replayed.next_at is None
    assert list(replayed.supervisor.events.oldest_first()) == robot.events


def test_what_is_to_come_is_not_shown_yet(replayed: ReplayedRobot, robot: RecordedRobot) -> None:
    held = next(step for step in robot.taken if isinstance(step.given, HoldRequest))

    replayed.advance_to(held.at - 1)
    assert "gate" not in replayed.supervisor.core.driving.holds
    replayed.advance_to(held.at)
    assert "gate" in replayed.supervisor.core.driving.holds


def test_its_clock_shows_the_time_of_day_of_then(replayed: ReplayedRobot) -> None:
    boot = boot_of(1)
    replayed.advance_to(boot.started_at + 10**9)

    shown = replayed.clock.wall_time(replayed.clock.now())
    assert (shown - boot.wall_at).total_seconds() == 1
    assert replayed.supervisor.started_at == boot.started_at
    assert replayed.supervisor.epoch == boot.epoch


def test_nothing_but_the_record_changes_it(replayed: ReplayedRobot, robot: RecordedRobot) -> None:
    replayed.advance_to(robot.taken[30].at)
    before = seen_of(replayed.supervisor._onboard)  # noqa: SLF001

    with pytest.raises(RecordingError):
        replayed.supervisor.submit(EmergencyStopRequest(engaged=True, reason="", actor=NOBODY))
    replayed.supervisor.stop_driving()
    replayed.supervisor.let_pass()

    assert seen_of(replayed.supervisor._onboard) == before  # noqa: SLF001
    assert replayed.supervisor.core.wake_at() is not None
    replayed.advance_to(robot.now)
    assert seen_of(replayed.supervisor._onboard) == seen_of(robot.onboard)  # noqa: SLF001


def test_frames_are_published_when_they_are_asked_for(
    replayed: ReplayedRobot, robot: RecordedRobot
) -> None:
    for step in robot.taken[::10]:
        replayed.advance_to(step.at)
        replayed.publish()
        newest = replayed.supervisor.frames.newest
        assert newest is not None
        assert newest.at == step.at
        assert newest.vehicle == replayed.supervisor.core.driving.vehicle


@pytest.mark.parametrize("number", [0, 5, 25, 61, 80])
def test_each_moment_is_found_from_the_last_checkpoint_before_it(
    folder: Path, robot: RecordedRobot, number: int
) -> None:
    at = robot.taken[number].at
    moment = to_datetime(at + offset_of(boot_of(1)))
    piece, place = piece_at(RecordedLog(folder), VERSION, moment)
    begins = [count for count in (0, *CHECKPOINTS) if count == 0 or robot.taken[count - 1].at <= at]

    assert abs(place - at) < 1_000, "the calendar has microseconds"
    assert piece.first == begins[-1] + 1
    shown = ReplayedRobot(piece, VERSION)
    shown.advance_to(at)
    again = ReplayedRobot(next(pieces_of(RecordedLog(folder), VERSION, None, None)), VERSION)
    again.advance_to(at)
    assert seen_of(shown.supervisor._onboard) == seen_of(again.supervisor._onboard)  # noqa: SLF001
    events = shown.supervisor.events
    assert events.newest == again.supervisor.events.newest


def test_what_was_lost_is_not_made_up(
    folder: Path, robot: RecordedRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    lost = [step.at for step in robot.taken[40:50]]
    hole = RecordedHole(1, 40, 10, 0, lost[0], lost[-1], "the queue was full")
    monkeypatch.setattr(RecordedLog, "holes", lambda _: [hole])

    for at in (lost[0], lost[-1], robot.taken[55].at):
        with pytest.raises(MomentNotRecordedError, match="that was lost: the queue was full"):
            piece_at(RecordedLog(folder), VERSION, to_datetime(at + offset_of(boot_of(1)) + 1_000))
    # From the next checkpoint on it is known again.
    at = robot.taken[60].at
    moment = to_datetime(at + offset_of(boot_of(1)) + 1_000)
    assert piece_at(RecordedLog(folder), VERSION, moment)[0].first == CHECKPOINTS[-1] + 1


def test_a_record_that_leads_to_something_else_is_not_shown(
    folder: Path, robot: RecordedRobot
) -> None:
    piece = next(pieces_of(RecordedLog(folder), VERSION, None, None))
    steps = list(islice(piece.steps, 40))
    place = next(n for n, step in enumerate(steps) if step.events)
    steps[place] = replace(steps[place], events=())
    piece = Piece(piece.run, piece.boot, piece.state, piece.first, iter(steps))

    with pytest.raises(ReplayDiffersError, match=f"step {place + 1} .* recorded was nothing"):
        ReplayedRobot(piece, VERSION).advance_to(robot.now)
