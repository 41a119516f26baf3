"""The compose file of a robot of several computers: it starts what the example describes."""

from typing import Any

import pytest
import yaml

from api.cli.parser import parser_for
from service.files.model_file import load_model
from service.files.robot_file import read_robot_file
from tests.support.shared import PROJECT

FILE = PROJECT / "docker" / "compose.devices.yaml"
EXAMPLE = PROJECT / "examples" / "three_computers"
SERVICES: dict[str, Any] = yaml.safe_load(FILE.read_text())["services"]


def options_of(service: str) -> Any:  # noqa: ANN401 - as argparse gives them
    command = SERVICES[service]["command"]
    return parser_for(command).parse_args(command)


def test_there_is_a_container_for_each_computer_of_the_example() -> None:
    model = load_model(EXAMPLE / "model.yaml").model
    robot = read_robot_file((EXAMPLE / "robot.yaml").read_text(), model)

    assert set(SERVICES) == {"supervisor", *robot.devices}
    for name in robot.devices:
        assert options_of(name).device == name


def test_each_page_is_published_where_its_service_listens() -> None:
    published = [port.rpartition(":")[2] for port in SERVICES["supervisor"]["ports"]]

    assert [str(options_of(name).port) for name in SERVICES] == published


@pytest.mark.parametrize("name", ["base", "arm"])
def test_devices_share_the_network_of_the_supervisor_and_are_asked_at_their_own_port(
    name: str,
) -> None:
    service = SERVICES[name]

    assert service["network_mode"] == "service:supervisor"
    assert str(options_of(name).port) in service["healthcheck"]["test"][-1]


@pytest.mark.parametrize("name", ["supervisor", "base", "arm"])
def test_what_a_computer_remembers_is_in_a_volume_of_its_own(name: str) -> None:
    assert f"{name}:{options_of(name).data}" in SERVICES[name]["volumes"]
