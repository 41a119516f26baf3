import pytest

from api.rosbridge.bridge import request_of
from domain.errors import InvalidValueError
from service.ros_interface.interface import RosInterface
from tests.support.live_robot import make_supervisor
from tests.support.rosbridge import SmallInterface, make_bridge

CHANGE_MODE = "system_modes_msgs/srv/ChangeMode"


def test_the_services_are_those_of_the_robot_and_those_of_rosapi() -> None:
    services = make_bridge(SmallInterface()).services

    assert {"/actuation/change_mode", "/rosapi/topics"} <= set(services)


@pytest.mark.parametrize(
    ("type_name", "args", "request_"),
    [
        (CHANGE_MODE, {"mode_name": "FAST"}, {"mode_name": "FAST"}),
        (CHANGE_MODE, ["FAST"], {"mode_name": "FAST"}),
        (CHANGE_MODE, [], {}),
        (CHANGE_MODE, None, {}),
        (
            "lifecycle_msgs/srv/ChangeState",
            [{"id": 0, "label": "activate"}],
            {"transition": {"id": 0, "label": "activate"}},
        ),
        ("rosapi_msgs/srv/TopicType", ["/estop"], {"topic": "/estop"}),
        ("std_srvs/srv/Empty", [], {}),
    ],
)
def test_values_in_order_are_given_their_names(
    type_name: str, args: dict[str, object] | list[object] | None, request_: dict[str, object]
) -> None:
    assert request_of(type_name, args) == request_


@pytest.mark.parametrize(
    ("type_name", "args", "words"),
    [
        (CHANGE_MODE, ["FAST", "SLOW"], "takes mode_name, and 2 values came"),
        ("std_srvs/srv/Empty", [1], "takes nothing"),
    ],
)
def test_more_values_than_there_are_fields_are_refused(
    type_name: str, args: list[object], words: str
) -> None:
    with pytest.raises(InvalidValueError, match=words):
        request_of(type_name, args)


async def test_every_service_of_the_robot_takes_a_list_without_values_for_no_fields() -> None:
    supervisor = make_supervisor()
    for service in RosInterface(supervisor).services.values():
        asks_nothing = service.type.rpartition("/")[2] not in ("ChangeMode", "ChangeState")

        if asks_nothing:
            with pytest.raises(InvalidValueError):
                request_of(service.type, ["a value"])
        else:
            assert request_of(service.type, ["a value"])
