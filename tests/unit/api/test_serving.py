from pathlib import Path

import pytest

from api.serving import ServeOptions, compose, greet, serve
from service.files.robot_file import RobotSettings
from tests.support.manual_clock import ManualClock

URL = "http://127.0.0.1:8000"


def greeting(options: ServeOptions) -> str:
    return "\n".join(greet(compose(options, ManualClock()), options, URL))


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    return tmp_path / "robot.yaml"


def test_without_arguments_the_example_is_served_with_everything_simulated() -> None:
    supervisor = compose(ServeOptions(), ManualClock())

    assert "actuation" in supervisor.model.systems
    assert supervisor.simulated == ("nodes", "signals", "vehicle")
    assert supervisor.warnings == ()


def test_a_robot_file_may_turn_the_mock_off(robot: Path) -> None:
    robot.write_text("mock: false\n")

    assert compose(ServeOptions(robot=robot), ManualClock()).simulated == ("nodes", "vehicle")


def test_the_command_line_may_turn_the_mock_on_again(robot: Path) -> None:
    robot.write_text("mock: false\n")

    supervisor = compose(ServeOptions(robot=robot, mock_signals=True), ManualClock())

    assert supervisor.mock is not None


def test_the_settings_of_a_robot_file_reach_the_core(robot: Path) -> None:
    robot.write_text("signals:\n  battery_level: {threshold: 0.3}\n")

    supervisor = compose(ServeOptions(robot=robot), ManualClock())

    assert supervisor.core.signal("battery_level").settings["threshold"] == 0.3


def test_the_greeting_says_what_is_served_where_and_what_is_not_real() -> None:
    told = greeting(ServeOptions())

    assert "the built-in example: 1 system, 2 nodes" in told
    assert f"page  {URL}/" in told
    assert f"curl {URL}/systems/actuation" in told
    assert "Simulated: nodes, signals, vehicle." in told


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.0.2.1"])
def test_an_address_that_others_reach_is_refused_without_a_word_about_passwords(
    host: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert serve(ServeOptions(host=host, port=0)) == 2
    assert "--anonymous" in capsys.readouterr().err


def test_nothing_set_is_a_robot_file_without_content() -> None:
    assert RobotSettings().mock is None
