import pytest

from api.cli.command_line import main
from api.serving.composition import ServeOptions
from api.serving.data_folder import USUAL


def test_serve_hands_on_what_it_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[ServeOptions] = []
    monkeypatch.setattr("api.serving.serving.serve", given.append)

    main(["serve", "--port", "0", "--allowed-host", "robot.local", "--allowed-host", "robot"])

    assert given == [ServeOptions(port=0, allowed_hosts=("robot.local", "robot"), data=USUAL)]


def test_the_greeting_can_be_json(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[ServeOptions] = []
    monkeypatch.setattr("api.serving.serving.serve", given.append)

    main(["serve", "--format", "json"])

    assert given == [ServeOptions(form="json", data=USUAL)]


def test_nodes_are_reached_through_what_was_said(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[ServeOptions] = []
    monkeypatch.setattr("api.serving.serving.serve", given.append)

    main(["serve", "--backend", "ros2"])

    assert given == [ServeOptions(backend="ros2", data=USUAL)]
