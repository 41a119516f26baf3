import pytest

from domain.errors import InvalidValueError
from tests.support.ros_robot import OPERATOR, RosRobot


@pytest.mark.parametrize(
    ("part", "node"), [("actuation", "actuation"), ("drive_base", "pilothouse")]
)
def test_a_part_has_the_services_of_the_mode_manager(part: str, node: str) -> None:
    offered = RosRobot().interface.services

    for name, type_name in [
        ("get_mode", "system_modes_msgs/srv/GetMode"),
        ("change_mode", "system_modes_msgs/srv/ChangeMode"),
        ("get_available_modes", "system_modes_msgs/srv/GetAvailableModes"),
    ]:
        service = offered[f"/{part}/{name}"]
        assert (service.type, service.node, service.of_a_node) == (type_name, node, False)


async def test_a_mode_is_entered_and_read_back(robot: RosRobot) -> None:
    changed = await robot.call("/actuation/change_mode", {"mode_name": "PERFORMANCE"})

    assert changed == {"success": True}
    assert await robot.call("/actuation/get_mode") == {"current_mode": "PERFORMANCE"}
    assert await robot.call("/drive_base/get_mode") == {"current_mode": "FAST"}


async def test_a_part_that_is_in_no_mode_has_none(robot: RosRobot) -> None:
    await robot.call("/actuation/change_state", {"transition": {"label": "configure"}})

    assert await robot.call("/actuation/get_mode") == {"current_mode": ""}


async def test_of_a_part_that_was_never_heard_of_the_mode_is_unknown() -> None:
    response = await RosRobot().interface.services["/actuation/get_mode"].call({}, OPERATOR)

    assert response == {"current_mode": "unknown"}


async def test_a_mode_that_does_not_exist_is_not_entered(robot: RosRobot) -> None:
    response = await robot.call("/actuation/change_mode", {"mode_name": "WARP"})

    assert response == {"success": False}


async def test_the_modes_of_a_part_are_those_of_the_model(robot: RosRobot) -> None:
    response = await robot.call("/drive_base/get_available_modes")

    assert response == {"available_modes": ["__DEFAULT__", "SLOW", "FAST"]}


@pytest.mark.parametrize("name", ["get_mode", "change_mode", "get_available_modes"])
async def test_the_older_form_that_names_the_node_is_refused(robot: RosRobot, name: str) -> None:
    with pytest.raises(InvalidValueError, match="'node_name'"):
        await robot.call(f"/drive_base/{name}", {"node_name": "drive_base"})
