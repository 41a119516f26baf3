from domain.computers import ComputerName
from domain.devices.settings import DeviceSettings
from domain.supervision_settings import SupervisionSettings
from tests.support.models import ARM, BASE

NAME = ComputerName("base")


def test_the_only_computer_of_a_robot_owns_all_nodes_and_follows_nobody() -> None:
    settings = SupervisionSettings()

    assert settings.device_of == settings.nodes_of_devices == {}
    assert settings.lead is None


def test_each_node_of_a_device_is_found_by_it_and_it_by_each_node() -> None:
    settings = SupervisionSettings(devices={NAME: DeviceSettings(NAME, (BASE, ARM))})

    assert settings.device_of == {BASE: NAME, ARM: NAME}
    assert settings.nodes_of_devices == {"base": (BASE, ARM)}
