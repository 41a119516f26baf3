"""Who a computer is among those of its robot follows from the file that they share."""

from domain.computers import SUPERVISOR, ComputerName
from service.files.robot_file import RobotSettings
from service.link.endpoints import USUAL
from service.link.place import Place, place_in

ARM, BASE = ComputerName("arm"), ComputerName("base")
DEVICES = {"base": {"parts": ["drive_base"]}, "arm": {"parts": ["manipulator"]}}


def place_of(device: str | None, *listen: str) -> Place:
    settings = RobotSettings.model_validate({"devices": DEVICES, "device": device})
    place = place_in(settings, listen)
    assert place is not None
    return place


def test_a_robot_of_one_computer_has_no_others() -> None:
    assert place_in(RobotSettings()) is None


def test_the_supervisor_expects_its_devices_where_it_listens() -> None:
    place = place_of(None)

    assert (place.name, place.is_supervisor, place.others) == (SUPERVISOR, True, (BASE, ARM))
    assert place.words == f"base, arm are expected at {USUAL}"


def test_a_device_looks_for_the_supervisor_and_speaks_with_the_other_devices_too() -> None:
    place = place_of("arm")

    assert (place.name, place.is_supervisor, place.others) == (ARM, False, (SUPERVISOR, BASE))
    assert place.words == f"the supervisor, whose word counts, is expected at {USUAL}"


def test_where_it_listens_may_be_said_by_whoever_starts_it() -> None:
    assert place_of("arm", "tcp/127.0.0.1:9000").endpoints.listen == ("tcp/127.0.0.1:9000",)
