import pytest

from api.rosbridge.bridge import request_of
from domain.actor import Actor
from domain.errors import InvalidValueError
from service.ros.interface.interface import RosInterface
from tests.support.live_robot import make_supervisor
from tests.support.manual_clock import ManualClock
from tests.support.rosbridge import SmallInterface, make_bridge

CHANGE_MODE = "system_modes_msgs/srv/ChangeMode"
ASKING = ("ChangeMode", "ChangeState", "DriveWaypoints", "StartTask")


def test_the_services_are_those_of_the_robot_and_those_of_rosapi() -> None:
    services = make_bridge(SmallInterface()).services

    assert {"/actuation/change_mode", "/rosapi/topics"} <= set(services)


async def test_an_address_may_call_so_often_and_another_one_as_well() -> None:
    clock = ManualClock()
    bridge = make_bridge(SmallInterface(), clock, calls_per_s=10)

    assert [bridge.may_call("/a", Actor("one")) for _ in range(21)] == [True] * 20 + [False]
    assert bridge.may_call("/a", Actor("another"))
    await clock.advance(0.1)
    assert [bridge.may_call("/a", Actor("one")) for _ in range(2)] == [True, False]


def test_who_calls_too_often_may_still_end_the_task() -> None:
    bridge = make_bridge(SmallInterface(), calls_per_s=1)

    assert [bridge.may_call("/cancel_tasks", Actor("one")) for _ in range(9)] == [True] * 9


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
        (
            "pilothouse_msgs/srv/StartTask",
            ["loop.csv", 0, "stanley"],
            {"file": "loop.csv", "start_index": 0, "controller": "stanley"},
        ),
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
        (CHANGE_MODE, ["FAST", "SLOW"], "has the fields mode_name, but 2 values were sent"),
        ("std_srvs/srv/Empty", [1], "has no fields"),
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
        asks_nothing = service.type.rpartition("/")[2] not in ASKING

        if asks_nothing:
            with pytest.raises(InvalidValueError):
                request_of(service.type, ["a value"])
        else:
            assert request_of(service.type, ["a value"])
