from pathlib import Path

import pytest

from api.cli.command_line import main
from api.serving.composition import ServeOptions
from api.serving.data_folder import USUAL

FILES = "robot.yaml", "--robot", "settings.yaml"
GIVEN = ServeOptions(Path("robot.yaml"), Path("settings.yaml"), data=USUAL)


@pytest.fixture
def served(monkeypatch: pytest.MonkeyPatch) -> list[ServeOptions]:
    given: list[ServeOptions] = []
    monkeypatch.setattr("api.serving.serving.serve", given.append)
    return given


def test_a_device_is_a_service_with_a_name(served: list[ServeOptions]) -> None:
    main(["device", "arm", *FILES])

    assert [options.device for options in served] == ["arm"]
    assert served[0].model == GIVEN.model
    assert served[0].robot == GIVEN.robot


def test_it_listens_where_it_is_told(served: list[ServeOptions]) -> None:
    main(["device", "arm", *FILES, "--link", "tcp/127.0.0.1:0", "--insecure-link", "--port", "0"])

    options = served[0]
    assert (options.link, options.insecure_link, options.port) == (("tcp/127.0.0.1:0",), True, 0)


def test_a_device_needs_the_file_that_says_what_it_owns(
    served: list[ServeOptions], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main(["device", "arm", "robot.yaml"])

    assert "--robot" in capsys.readouterr().err
    assert served == []
