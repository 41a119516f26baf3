import pytest

from api.rosbridge.definitions import full_type
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
    assert told["types"][-1] == "pilothouse_msgs/msg/EmergencyStop"
    assert len(told["types"]) == len(TOPICS)


async def test_all_services_are_told_and_rosapi_itself(rosapi: RosApi) -> None:
    told = (await ask(rosapi, "services"))["services"]

    assert told[:2] == ["/actuation/change_mode", "/actuation/get_mode"]
    assert "/rosapi/topics" in told


async def test_the_nodes_are_those_that_have_services(rosapi: RosApi) -> None:
    assert (await ask(rosapi, "nodes"))["nodes"] == ["/actuation", "/pilothouse", "/rosapi"]


@pytest.mark.parametrize("name", ["/estop", "estop"])
async def test_the_type_of_a_topic_is_told(rosapi: RosApi, name: str) -> None:
    assert await ask(rosapi, "topic_type", topic=name) == {
        "type": "pilothouse_msgs/msg/EmergencyStop"
    }


@pytest.mark.parametrize("name", ["/actuation/get_mode", "actuation/get_mode"])
async def test_the_type_of_a_service_is_told(rosapi: RosApi, name: str) -> None:
    told = await ask(rosapi, "service_type", service=name)

    assert told == {"type": "system_modes_msgs/srv/GetMode"}


async def test_what_is_not_there_has_no_type(rosapi: RosApi) -> None:
    assert await ask(rosapi, "topic_type", topic="/nothing") == {"type": ""}
    assert await ask(rosapi, "service_type") == {"type": ""}


@pytest.mark.parametrize(
    "asked", ["pilothouse_msgs/msg/SystemState", "gem_state_msgs/SystemStateStamped"]
)
async def test_a_topic_is_found_by_either_name_of_its_type(rosapi: RosApi, asked: str) -> None:
    assert await ask(rosapi, "topics_for_type", type=asked) == {"topics": ["/system_state"]}


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


async def test_a_viewer_gets_all_topics_with_their_definitions(rosapi: RosApi) -> None:
    told = await ask(rosapi, "topics_and_raw_types")

    assert told["topics"] == TOPICS
    assert len(told["types"]) == len(told["typedefs_full_text"]) == len(TOPICS)
    assert told["typedefs_full_text"][-1] == (
        "std_msgs/Header header\nbool enabled\n" + "=" * 80 + "\nMSG: std_msgs/Header\n"
        "builtin_interfaces/Time stamp\nstring frame_id\n" + "=" * 80
        + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec"
    )  # fmt: skip


async def test_what_a_node_offers_and_hears_is_told(rosapi: RosApi) -> None:
    assert await ask(rosapi, "node_details", node="/actuation") == {
        "publishing": ["/actuation/mode_event", "/actuation/mode_request_info"],
        "subscribing": [],
        "services": ["/actuation/change_mode", "/actuation/get_mode"],
    }
    own = await ask(rosapi, "node_details", node="pilothouse")
    assert (own["publishing"], own["subscribing"]) == (["/system_state"], ["/estop"])
    nothing: Fields = {"publishing": [], "subscribing": [], "services": []}
    assert await ask(rosapi, "node_details", node="/tail") == nothing


@pytest.mark.parametrize("asked", ["system_modes_msgs/srv/GetMode", "system_modes_msgs/GetMode"])
async def test_services_are_found_by_their_type(rosapi: RosApi, asked: str) -> None:
    told = await ask(rosapi, "services_for_type", type=asked)

    assert told == {"services": ["/actuation/get_mode"]}
    assert await ask(rosapi, "services_for_type") == {"services": []}


async def test_who_has_a_topic_or_service_is_told(rosapi: RosApi) -> None:
    publishers = await ask(rosapi, "publishers", topic="/system_state")
    subscribers = await ask(rosapi, "subscribers", topic="estop")
    node = await ask(rosapi, "service_node", service="/actuation/get_mode")
    providers = await ask(rosapi, "service_providers", service="system_modes_msgs/srv/GetMode")

    assert (publishers, subscribers) == (
        {"publishers": ["/pilothouse"]},
        {"subscribers": ["/pilothouse"]},
    )
    assert (node, providers) == ({"node": "/actuation"}, {"providers": ["/actuation"]})
    assert await ask(rosapi, "publishers", topic="/estop") == {"publishers": []}
    assert await ask(rosapi, "service_node", service="/x") == {"node": ""}


@pytest.mark.parametrize(
    "asked", ["pilothouse_msgs/msg/EmergencyStop", "gem_state_msgs/EstopStamped"]
)
async def test_the_details_of_a_message_have_the_types_in_it(rosapi: RosApi, asked: str) -> None:
    first, *nested = (await ask(rosapi, "message_details", type=asked))["typedefs"]

    assert first == {
        "type": full_type(asked),
        "fieldnames": ["header", "enabled"],
        "fieldtypes": ["std_msgs/msg/Header", "bool"],
        "fieldarraylen": [-1, -1],
        "examples": ["{}", "False"],
        "constnames": [],
        "constvalues": [],
    }
    assert [each["type"] for each in nested] == [
        "std_msgs/msg/Header",
        "builtin_interfaces/msg/Time",
    ]


async def test_the_details_of_a_service_are_told(rosapi: RosApi) -> None:
    type_name = "lifecycle_msgs/srv/ChangeState"
    request = (await ask(rosapi, "service_request_details", type=type_name))["typedefs"]
    response = (await ask(rosapi, "service_response_details", type=type_name))["typedefs"]

    assert [each["type"] for each in request] == [
        "lifecycle_msgs/srv/ChangeState_Request",
        "lifecycle_msgs/msg/Transition",
    ]
    assert response[0]["fieldnames"] == ["success"]
    assert await ask(rosapi, "message_details", type="x/y") == {"typedefs": []}
    assert await ask(rosapi, "service_request_details", type="x") == {"typedefs": []}


async def test_what_there_is_not_is_told_as_empty(rosapi: RosApi) -> None:
    assert await ask(rosapi, "action_servers") == {"action_servers": []}
    assert await ask(rosapi, "get_param_names") == {"names": []}
    assert (await ask(rosapi, "get_ros_version"))["version"] == 2
