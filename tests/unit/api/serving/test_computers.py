"""What has to be right before a computer joins the others of its robot."""

import sys

import pytest

from api.serving.computers import make_link
from api.serving.misuse import MisuseError
from domain.computers import SUPERVISOR
from service.files.robot_file import RobotSettings
from service.link.device_end import DeviceEnd
from service.link.end import LinkEnd
from service.link.place import place_in
from service.link.supervisor_end import SupervisorEnd
from tests.support.linked_robot import settings_of
from tests.support.manual_clock import ManualClock
from tests.support.models import actuation_model

ZENOH = "service.link.zenoh_link"
NETWORK = {"listen": ["tcp/0.0.0.0:7470"], "connect": ["tcp/192.0.2.1:7470"]}


def linked(robot: RobotSettings, *, insecure: bool = False) -> LinkEnd:
    place = place_in(robot)
    assert place is not None
    return make_link(place, actuation_model(), robot, ManualClock(), insecure=insecure)


def test_each_computer_has_its_own_end() -> None:
    pytest.importorskip("zenoh")

    assert isinstance(linked(settings_of(SUPERVISOR)), SupervisorEnd)
    assert isinstance(linked(settings_of("arm")), DeviceEnd)


def test_without_zenoh_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, ZENOH, None)

    with pytest.raises(MisuseError, match=r"pip install 'pilothouse\[link\]'"):
        linked(settings_of(SUPERVISOR))


def test_a_network_in_which_anybody_could_command_the_robot_is_refused() -> None:
    pytest.importorskip("zenoh")

    with pytest.raises(MisuseError, match="insecure-link"):
        linked(settings_of("arm", link=NETWORK))


def test_it_is_allowed_by_who_says_so() -> None:
    pytest.importorskip("zenoh")

    assert isinstance(linked(settings_of("arm", link=NETWORK), insecure=True), DeviceEnd)


def test_the_files_of_a_certificate_are_those_of_the_computer() -> None:
    pytest.importorskip("zenoh")
    files = {"ca": "ca.pem", "certificate": "/no/{name}.pem", "key": "/no/{name}.key"}
    robot = settings_of("arm", link={"connect": ["quic/192.0.2.1:7470"], **files})

    with pytest.raises(MisuseError, match=r"ca\.pem|arm\.pem"):
        linked(robot)
