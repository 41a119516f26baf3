import pytest
from pydantic import ValidationError

from domain.navigation import NavigationSettings
from domain.paths.speed_profile import SpeedLimits
from domain.tasks.settings import TaskSettings
from domain.timebase import seconds
from domain.tracking.trackers import TRACKERS
from service.files.driving_block import DrivingBlock, StartTaskBlock, TasksBlock


def test_driving_of_which_nothing_is_said_is_as_usual() -> None:
    assert DrivingBlock().to_task_settings() == TaskSettings()
    assert DrivingBlock().to_navigation_settings() == NavigationSettings()


def test_everything_that_is_said_holds() -> None:
    block = DrivingBlock.model_validate(
        {
            "max_start_distance_m": 7.5,
            "pose_stale_after_s": 0.4,
            "max_cross_track_m": 1.5,
            "max_cross_track_for_s": 2.5,
            "no_progress_for_s": 30,
            "lateral_acceleration_mps2": 1.1,
            "acceleration_mps2": 1.2,
            "braking_mps2": 1.3,
        }
    )

    assert block.to_task_settings() == TaskSettings(
        max_start_distance_m=7.5, pose_stale_after=seconds(0.4), braking_mps2=1.3
    )
    assert block.to_navigation_settings() == NavigationSettings(
        max_cross_track_m=1.5,
        max_cross_track_for=seconds(2.5),
        no_progress_for=seconds(30),
        speed=SpeedLimits(lateral_acceleration_mps2=1.1, acceleration_mps2=1.2, braking_mps2=1.3),
    )


@pytest.mark.parametrize("key", sorted(DrivingBlock.model_fields))
@pytest.mark.parametrize("wrong", [-1, True, "1", float("nan"), float("inf"), 86_401])
def test_what_cannot_be_is_refused_where_it_stands(key: str, wrong: object) -> None:
    with pytest.raises(ValidationError) as caught:
        DrivingBlock.model_validate({key: wrong})

    (fault,) = caught.value.errors()
    assert fault["loc"] == (key,)


@pytest.mark.parametrize("key", sorted({*DrivingBlock.model_fields} - {"max_cross_track_for_s"}))
def test_nothing_at_all_would_never_let_a_task_run(key: str) -> None:
    with pytest.raises(ValidationError, match="greater than 0"):
        DrivingBlock.model_validate({key: 0})


def test_a_path_may_be_lost_at_once() -> None:
    block = DrivingBlock.model_validate({"max_cross_track_for_s": 0})

    assert block.to_navigation_settings().max_cross_track_for == 0


@pytest.mark.parametrize("key", sorted(DrivingBlock.model_fields))
def test_a_whole_number_is_as_good_as_another(key: str) -> None:
    assert getattr(DrivingBlock.model_validate({key: 1}), key) == 1.0


def test_tasks_by_name_need_a_folder() -> None:
    assert TasksBlock(folder="tracks").folder == "tracks"

    for settings in ({}, {"folder": ""}, {"folder": "a", "file": "b"}):
        with pytest.raises(ValidationError):
            TasksBlock.model_validate(settings)


def test_a_start_task_needs_a_file_and_nothing_else() -> None:
    block = StartTaskBlock.model_validate({"file": "tracks/loop.csv"})

    assert (block.file, block.controller, block.speed_mps) == (
        "tracks/loop.csv",
        "pure_pursuit",
        2.8,
    )


@pytest.mark.parametrize(
    ("settings", "where"),
    [
        ({}, "file"),
        ({"file": ""}, "file"),
        ({"file": "x" * 1_001}, "file"),
        ({"file": 3}, "file"),
        ({"file": "x.csv", "controller": "autopilot"}, "controller"),
        ({"file": "x.csv", "speed_mps": 0}, "speed_mps"),
        ({"file": "x.csv", "speed": 2.0}, "speed"),
    ],
)
def test_a_start_task_that_cannot_be_is_refused(settings: dict[str, object], where: str) -> None:
    with pytest.raises(ValidationError) as caught:
        StartTaskBlock.model_validate(settings)

    (fault,) = caught.value.errors()
    assert fault["loc"] == (where,)


@pytest.mark.parametrize("controller", TRACKERS)
def test_a_start_task_may_name_each_tracker_that_there_is(controller: str) -> None:
    block = StartTaskBlock.model_validate({"file": "x.csv", "controller": controller})

    assert block.controller == controller


def test_who_names_a_tracker_that_there_is_not_is_told_which_there_are() -> None:
    with pytest.raises(ValidationError, match="'autopilot'; known: pure_pursuit, stanley"):
        StartTaskBlock.model_validate({"file": "x.csv", "controller": "autopilot"})
