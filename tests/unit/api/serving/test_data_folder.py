"""In which folder a robot keeps what survives a restart."""

from pathlib import Path

import pytest

from api.serving.data_folder import MEMORY, USUAL, data_folder, robot_name


def test_a_folder_that_is_chosen_is_taken_as_it_is() -> None:
    assert data_folder("data", "gem_e2", {"STATE_DIRECTORY": "/var/lib/x"}) == Path("data")


def test_in_memory_there_is_none() -> None:
    assert data_folder(MEMORY, "gem_e2", {}) is None


@pytest.mark.parametrize(
    ("environment", "folder"),
    [
        ({"STATE_DIRECTORY": "/var/lib/pilothouse"}, "/var/lib/pilothouse/gem_e2"),
        ({"STATE_DIRECTORY": "/var/lib/a:/var/lib/b"}, "/var/lib/a/gem_e2"),
        ({"XDG_STATE_HOME": "/home/me/state"}, "/home/me/state/pilothouse/gem_e2"),
        ({"XDG_STATE_HOME": "state"}, f"{Path.home()}/.local/state/pilothouse/gem_e2"),
        ({}, f"{Path.home()}/.local/state/pilothouse/gem_e2"),
    ],
)
def test_the_usual_folder_is_where_user_and_system_keep_state(
    environment: dict[str, str], folder: str
) -> None:
    assert data_folder(USUAL, "gem_e2", environment) == Path(folder)


@pytest.mark.parametrize(
    ("name", "folder"), [("../../etc", "_.._etc"), ("my robot", "my_robot"), ("..", "robot")]
)
def test_a_name_of_a_file_leads_to_no_other_folder(name: str, folder: str) -> None:
    assert data_folder(USUAL, name, {"STATE_DIRECTORY": "/state"}) == Path("/state") / folder


def test_a_robot_is_named_by_its_robot_file_or_else_by_its_model() -> None:
    assert robot_name("rover-7", Path("models/actuation.yaml")) == "rover-7"
    assert robot_name(None, Path("models/actuation.yaml")) == "actuation"
