from pathlib import Path
from typing import get_args

import pytest

from api.cli.command_line import main
from api.cli.commands.tracker import COMMAND_TYPES
from api.serving.tracking import TrackerOptions
from domain.tracking.trackers import TRACKERS
from service.files.ros2_block import CommandType

USUAL = TrackerOptions("pure_pursuit", "/navigate_waypoints")


@pytest.fixture
def tracked(monkeypatch: pytest.MonkeyPatch) -> list[TrackerOptions]:
    given: list[TrackerOptions] = []
    monkeypatch.setattr("api.serving.tracking.track", given.append)
    return given


def test_nothing_has_to_be_said(tracked: list[TrackerOptions]) -> None:
    main(["tracker"])

    assert tracked == [USUAL]


def test_what_is_driven_and_how_can_be_said(tracked: list[TrackerOptions]) -> None:
    what = ("tracker", "gem.yaml", "--robot", "robot.yaml", "--tracker", "stanley")
    action = ("--action", "/gem/drive_along", "--odometry", "/gem/odometry")
    command = ("--command", "/gem/drive", "--command-type", COMMAND_TYPES[2])
    main([*what, *action, *command, "--log-level", "debug"])

    assert tracked == [
        TrackerOptions(
            "stanley",
            "/gem/drive_along",
            Path("gem.yaml"),
            Path("robot.yaml"),
            "/gem/odometry",
            "/gem/drive",
            "ackermann_msgs/msg/AckermannDrive",
            "debug",
        )
    ]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--tracker", "stanly"], "did you mean stanley?"),
        (["--action", "navigate"], "invalid topic name 'navigate'"),
        (["--odometry", "/odom/"], "such as /battery_state"),
        (["--command-type", "Twist"], "geometry_msgs/msg/Twist"),
    ],
)
def test_what_is_misspelt_is_told(
    arguments: list[str],
    words: str,
    tracked: list[TrackerOptions],
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit):
        main(["tracker", *arguments])

    assert words in capsys.readouterr().err
    assert tracked == []


@pytest.mark.parametrize("name", TRACKERS)
def test_every_tracker_can_be_chosen(name: str, tracked: list[TrackerOptions]) -> None:
    main(["tracker", "--tracker", name])

    assert tracked[0].controller == name


def test_every_type_of_commands_can_be_chosen() -> None:
    assert get_args(CommandType) == COMMAND_TYPES
