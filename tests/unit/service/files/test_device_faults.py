"""What is wrong with the devices of a robot file, and where."""

import pytest

from domain.findings import Finding
from domain.parts.system_model import SmhModel
from service.files.model_file import read_model
from service.files.robot_file import InvalidRobotFileError, read_robot_file
from tests.support.models import actuation_model
from tests.unit.service.files.test_devices_block import SYSTEMS

MODEL = actuation_model()


def findings(text: str, model: SmhModel = MODEL) -> tuple[Finding, ...]:
    with pytest.raises(InvalidRobotFileError) as caught:
        read_robot_file(text, model)
    return caught.value.findings


def fault(text: str, model: SmhModel = MODEL) -> tuple[str, int | None, int | None, str]:
    (found,) = findings(text, model)
    return found.code, found.line, found.column, found.message


def of_base(keys: str) -> str:
    return f"devices:\n  base:\n    parts: [drive_base]\n    {keys}\n"


def test_an_unknown_part_is_told_where_it_stands() -> None:
    text = "devices:\n  base:\n    parts: [drive_base, manipulatr]\n"

    code, line, column, message = fault(text)

    assert (code, line, column) == ("UNKNOWN_PART", 3, 25)
    assert message == "there is no part 'manipulatr'; did you mean manipulator?"


def test_a_node_has_one_owner() -> None:
    text = "devices:\n  base: {parts: [drive_base]}\n  arm: {parts: [manipulator, drive_base]}\n"

    code, line, _, message = fault(text)

    assert (code, line) == ("OWNED_TWICE", 3)
    assert message == "drive_base is owned by base already"


def test_a_node_has_one_owner_through_systems_too() -> None:
    text = "devices:\n  base: {parts: [drive_base]}\n  arm: {parts: [actuation]}\n"

    assert fault(text)[3] == "drive_base of actuation is owned by base already"


def test_naming_a_node_and_its_system_in_one_device_is_fine() -> None:
    assert read_robot_file("devices: {all: {parts: [actuation, drive_base]}}", MODEL).devices


def test_a_signal_is_read_by_one_device() -> None:
    text = (
        "signals: {motor: {part: drive_base}}\ndevices:\n  base: {parts: [drive_base]}\n"
        "  arm: {parts: [manipulator], signals: [motor]}\n"
    )

    code, line, column, message = fault(text)

    assert (code, line, column) == ("OWNED_TWICE", 4, 41)
    assert message == "motor is read by base already"


def test_a_signal_of_a_part_that_another_device_names_is_told_at_the_owner_of_the_part() -> None:
    text = (
        "signals: {motor: {part: drive_base}}\ndevices:\n"
        "  arm: {parts: [manipulator], signals: [motor]}\n  base: {parts: [drive_base]}\n"
    )

    code, line, column, message = fault(text)

    assert (code, line, column) == ("OWNED_TWICE", 4, 3)
    assert message == "motor is read by arm already"


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("supervisor", "the computer that supervises"),
        ("drive_base", "drive_base is a part already"),
        ("actuation", "actuation is a part already"),
    ],
)
def test_a_device_has_a_name_of_its_own(name: str, words: str) -> None:
    code, line, column, message = fault(f"devices:\n  {name}: {{parts: [drive_base]}}\n")

    assert (code, line, column) == ("DEVICE_NAME", 2, 3)
    assert words in message


def test_a_name_that_cannot_be_that_of_a_certificate_is_refused() -> None:
    assert fault("devices:\n  My Base: {parts: [drive_base]}\n")[0] == "INVALID_VALUE"


@pytest.mark.parametrize("keys", ["vehicle: true", "driving: {}"])
def test_the_vehicle_is_the_supervisors(keys: str) -> None:
    code, line, _, message = fault(of_base(keys))

    assert (code, line) == ("INVALID_VALUE", 2)
    assert "vehicle, tasks and holds are the supervisor's" in message


def test_the_vehicle_is_no_part_of_a_device() -> None:
    code, line, column, _ = fault("devices:\n  base: {parts: [drive_base, vehicle]}\n")

    assert (code, line, column) == ("VEHICLE_ELSEWHERE", 2, 30)


def test_a_device_without_parts_is_refused() -> None:
    assert fault("devices: {base: {parts: []}}")[0] == "INVALID_VALUE"


def test_a_system_without_nodes_gives_a_device_nothing() -> None:
    model = read_model("empty: {ros__parameters: {type: system}}\n" + SYSTEMS).model

    assert fault("devices: {one: {parts: [empty]}}", model)[3] == "empty has no nodes"


def test_an_unknown_signal_is_told() -> None:
    code, line, _, message = fault(of_base("signals: [batery_level]"))

    assert (code, line) == ("UNKNOWN_SIGNAL", 4)
    assert "did you mean battery_level?" in message


def test_a_monitor_is_computed_and_not_read() -> None:
    text = "signals: {mean: {of: temperature, statistic: mean, window_s: 5}}\n"

    code, _, _, message = fault(text + of_base("signals: [mean]"))

    assert code == "INVALID_VALUE"
    assert message == "mean is a monitor: base computes it if it reads temperature"


# --- when cut off --------------------------------------------------------------------------------


def test_a_device_acts_alone_only_after_it_is_cut_off() -> None:
    code, line, _, message = fault(of_base("offline: {after_s: 1, target: {drive_base: inactive}}"))

    assert (code, line) == ("OFFLINE_TOO_SOON", 4)
    assert "1.5 s after the last echo" in message


def test_the_time_until_it_is_cut_off_is_that_of_the_link() -> None:
    text = "link: {lost_s: 3}\n" + of_base("offline: {reactions: true}")

    assert fault(text)[0] == "OFFLINE_TOO_SOON"


def test_a_device_that_does_nothing_when_cut_off_has_no_time() -> None:
    assert read_robot_file("link: {lost_s: 3}\n" + of_base("offline: {}"), MODEL).devices


@pytest.mark.parametrize(
    ("target", "code", "words"),
    [
        ("{manipulator: inactive}", "NOT_OWN", "manipulator is not all base's own"),
        ("{actuation: inactive}", "NOT_OWN", "actuation is not all base's own"),
        ("{drive_bas: inactive}", "UNKNOWN_PART", "did you mean drive_base?"),
        ("{drive_base: inactiv}", "UNKNOWN_STATE", "did you mean inactive?"),
        ("{drive_base: deactivating}", "UNKNOWN_STATE", "is none of"),
        ("{drive_base: active.STRONG}", "UNKNOWN_MODE", "it has __DEFAULT__, SLOW, FAST"),
        ("{drive_base: inactive.SLOW}", "INVALID_VALUE", "only active has modes"),
    ],
)
def test_a_target_that_a_device_cannot_pursue_alone_is_told(
    target: str, code: str, words: str
) -> None:
    found, line, _, message = fault(of_base(f"offline: {{target: {target}}}"))

    assert (found, line) == (code, 4)
    assert words in message


def test_a_system_of_which_one_mode_names_a_foreign_part_is_not_its_own() -> None:
    text = "devices: {one: {parts: [base], offline: {target: {base: inactive}}}}"

    assert fault(text, read_model(SYSTEMS).model)[0] == "NOT_OWN"


def test_two_targets_for_one_node_are_told() -> None:
    text = (
        "devices: {all: {parts: [actuation],"
        " offline: {target: {actuation: inactive, drive_base: active}}}}"
    )

    assert fault(text)[3] == "drive_base has a target already, by actuation"


def test_all_that_is_wrong_is_told_at_once() -> None:
    text = "devices:\n  supervisor: {parts: [nothing]}\n  b: {parts: [drive_base], signals: [x]}\n"

    codes = {found.code for found in findings(text)}

    assert codes == {"DEVICE_NAME", "UNKNOWN_PART", "UNKNOWN_SIGNAL"}
