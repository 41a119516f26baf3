"""The job behind `GET /frames`, which has its stories in `test_frames_route.py`."""

import json
import pickle
from datetime import timedelta
from pathlib import Path

import pytest

from api.streaming.client_input import STATE_TOPICS
from api.streaming.frame_jobs import WantedFrame, frame_of
from domain.errors import StorageDegradedError
from service.recorded_pieces import MomentNotRecordedError
from tests.support.recorded_robot import BOOT, RecordedRobot
from tests.support.stored_robot import held_on_its_way, store


@pytest.fixture(scope="module")
def robot() -> RecordedRobot:
    return held_on_its_way()


@pytest.fixture(scope="module")
def folder(robot: RecordedRobot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data") / "robot"
    store(folder, robot, checkpoints=(20,))
    return folder


def wanted(folder: Path, after_s: float) -> WantedFrame:
    moment = BOOT.wall_at + timedelta(seconds=after_s)
    return WantedFrame(str(folder), moment, BOOT.wall_at, ("vehicle",))


def test_the_frame_has_all_topics_and_the_moment(folder: Path) -> None:
    asked = pickle.loads(pickle.dumps(wanted(folder, 2.0005)))

    shown = json.loads(frame_of(asked))

    assert shown.keys() >= STATE_TOPICS
    assert shown["at"] == "2026-01-01T00:00:02.000Z"
    assert shown["system_state"]["simulated"] == ["vehicle"]
    assert "gate" in shown["holds"]


def test_a_moment_that_is_not_there_and_a_folder_that_is_not(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(MomentNotRecordedError):
        frame_of(wanted(folder, 3_600))
    with pytest.raises(StorageDegradedError, match="the record cannot be read"):
        frame_of(wanted(tmp_path, 1))
