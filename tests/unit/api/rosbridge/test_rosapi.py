import pytest

from api.rosbridge.rosapi import RosApi
from domain.actor import Actor
from domain.errors import InvalidValueError
from service.ros.interface.endpoints import Fields, OfferedTopic, SubscribedTopic
from tests.support.manual_clock import ManualClock
from tests.support.rosbridge import SmallInterface

TOPICS = [
    "/system_state",
    "/actuation/mode_event",
    "/actuation/mode_request_info",
    "/estop",
]


@pytest.fixture
def rosapi() -> RosApi:
    interface = SmallInterface()
    topics: list[OfferedTopic | SubscribedTopic] = [
        *interface.topics.values(),
        *interface.heard.values(),
    ]
    return RosApi(interface.services, topics, ManualClock())


async def ask(rosapi: RosApi, service: str, /, **request: object) -> Fields:
    return await rosapi.services[f"/rosapi/{service}"].call(request, Actor("test"))


async def test_all_topics_are_told_with_their_types(rosapi: RosApi) -> None:
    told = await ask(rosapi, "topics")

    assert told["topics"] == TOPICS
    assert told["types"][-1] == "gem_state_msgs/msg/EstopStamped"
    assert len(told["types"]) == len(TOPICS)


async def test_all_services_are_told_and_rosapi_itself(rosapi: RosApi) -> None:
    told = (await ask(rosapi, "services"))["services"]

    assert told[:2] == ["/actuation/change_mode", "/actuation/get_mode"]
    assert "/rosapi/topics" in told


async def test_the_nodes_are_those_that_have_services(rosapi: RosApi) -> None:
    assert (await ask(rosapi, "nodes"))["nodes"] == ["/actuation", "/rosapi"]


@pytest.mark.parametrize("name", ["/estop", "estop"])
async def test_the_type_of_a_topic_is_told(rosapi: RosApi, name: str) -> None:
    assert await ask(rosapi, "topic_type", topic=name) == {
        "type": "gem_state_msgs/msg/EstopStamped"
    }


@pytest.mark.parametrize("name", ["/actuation/get_mode", "actuation/get_mode"])
async def test_the_type_of_a_service_is_told(rosapi: RosApi, name: str) -> None:
    told = await ask(rosapi, "service_type", service=name)

    assert told == {"type": "system_modes_msgs/srv/GetMode"}


async def test_what_is_not_there_has_no_type(rosapi: RosApi) -> None:
    assert await ask(rosapi, "topic_type", topic="/nothing") == {"type": ""}
    assert await ask(rosapi, "service_type") == {"type": ""}


@pytest.mark.parametrize(
    "asked", ["system_modes_msgs/msg/ModeEvent", "system_modes_msgs/ModeEvent"]
)
async def test_topics_are_found_by_their_type(rosapi: RosApi, asked: str) -> None:
    told = await ask(rosapi, "topics_for_type", type=asked)

    assert told == {"topics": ["/actuation/mode_event", "/actuation/mode_request_info"]}


async def test_no_topic_is_of_no_type(rosapi: RosApi) -> None:
    assert await ask(rosapi, "topics_for_type") == {"topics": []}


async def test_the_time_is_told_to_clients_of_ros_1_and_of_ros_2(rosapi: RosApi) -> None:
    told = (await ask(rosapi, "get_time"))["time"]

    assert (told["sec"], told["nanosec"]) == (1_767_225_600, 0)
    assert (told["secs"], told["nsecs"]) == (1_767_225_600, 0)


async def test_a_field_that_is_not_there_is_refused(rosapi: RosApi) -> None:
    with pytest.raises(InvalidValueError, match="no field 'name'"):
        await ask(rosapi, "topic_type", name="/estop")
