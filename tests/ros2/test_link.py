"""The link to ROS 2, against real nodes in processes of their own."""

import asyncio
import sys
import threading
from itertools import pairwise
from statistics import median
from typing import Any

import pytest

from domain.errors import InvalidValueError
from service.ros.graph.graph import (
    Client,
    GraphFailedError,
    Lane,
    Publisher,
    Qos,
    UnknownTypeError,
)
from tests.ros2.support.camera_process import camera
from tests.ros2.support.links import POLL_S, WITHIN_S, Link, make_link, ready
from tests.ros2.support.nodes_process import nodes_process
from tests.support.waiting import until

pytestmark = pytest.mark.ros2

GET_STATE = "lifecycle_msgs/srv/GetState"
CHANGE_STATE = "lifecycle_msgs/srv/ChangeState"
TRANSITION_EVENT = "lifecycle_msgs/msg/TransitionEvent"
TRIGGER = "std_srvs/srv/Trigger"
EMPTY = "std_msgs/msg/Empty"
LEASE_S = 0.5
BRIEFLY_S = 0.3


async def configure(client: Client) -> bool:
    response = await client.call({"transition": {"label": "configure"}}, WITHIN_S)
    return bool(response.success)


def threads() -> set[str]:
    return {thread.name for thread in threading.enumerate() if thread.name.startswith("ros2 ")}


async def test_no_thread_of_ros_keeps_the_interpreter_from_the_event_loop(link: Link) -> None:
    assert sys.getswitchinterval() <= 0.001


async def test_a_node_is_asked_and_told_what_to_do(link: Link) -> None:
    node = link.node("pilothouse", Lane.STATES)
    state = node.client("/left/arm/get_state", GET_STATE)
    change = node.client("/left/arm/change_state", CHANGE_STATE)
    assert not state.is_ready()

    with nodes_process({"name": "left/arm"}):
        before = await (await ready(state)).call({}, WITHIN_S)
        assert await configure(await ready(change))
        after = await state.call({}, WITHIN_S)

    assert before.current_state.label == "unconfigured"
    assert after.current_state.label == "inactive"


async def test_a_process_that_was_started_anew_is_one_server_more(link: Link) -> None:
    state = link.node("pilothouse", Lane.STATES).client("/left/arm/get_state", GET_STATE)
    assert state.servers() == 0

    with nodes_process({"name": "left/arm"}) as process:
        await until(lambda: state.servers() == 1, POLL_S)
        process.kill()
        process.start()
        await until(lambda: state.servers() == 2, POLL_S)


@pytest.mark.parametrize("domain", ["garage", "999", "-5", "4294967296"])
def test_what_is_no_domain_is_told(domain: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)

    with pytest.raises(RuntimeError, match=f"whole number from 0 to 232, not '{domain}'"):
        make_link()


async def test_messages_are_noticed_with_their_stamps_and_without_being_read(link: Link) -> None:
    node = link.node("pilothouse", Lane.SENSORS)
    heard: list[int | None] = []
    node.watch_arrivals("/cloud", "sensor_msgs/msg/PointCloud2", heard.append)
    node.watch_arrivals("/beat", EMPTY, heard.append)
    talker = link.node("talker", Lane.GATEWAY)
    cloud = talker.publisher("/cloud", "sensor_msgs/msg/PointCloud2", Qos.EVENTS)
    beat = talker.publisher("/beat", EMPTY, Qos.EVENTS)

    def told(stamp: int | None, publish: Any) -> bool:  # noqa: ANN401
        publish()
        return stamp in heard

    stamped = {"header": {"stamp": {"sec": 1_700_000_000, "nanosec": 5}}, "data": [1, 2, 3]}
    stamp_ns = 1_700_000_000_000_000_005
    await until(lambda: told(stamp_ns, lambda: cloud.publish(stamped)), POLL_S)
    await until(lambda: told(None, lambda: beat.publish({})), POLL_S)

    assert set(heard) == {stamp_ns, None}


async def test_large_messages_of_a_reliable_publisher_all_arrive(link: Link) -> None:
    rate_hz, size = 30, 1_000_000
    heard: list[int | None] = []
    node = link.node("pilothouse", Lane.SENSORS)
    node.watch_arrivals("/image", "sensor_msgs/msg/Image", heard.append)

    with camera(rate_hz, size):
        await until(lambda: len(heard) >= 60, POLL_S)

    newest = [stamp for stamp in heard[-31:] if stamp is not None]
    gaps_s = [(later - stamp) / 1e9 for stamp, later in pairwise(newest)]
    assert len(newest) == 31
    assert median(gaps_s) == pytest.approx(1 / rate_hz, rel=0.1)


async def test_a_publisher_that_is_not_reliable_is_heard_after_one_that_is(link: Link) -> None:
    heard: list[int | None] = []
    link.node("pilothouse", Lane.SENSORS).watch_arrivals("/beat", EMPTY, heard.append)
    talker = link.node("talker", Lane.GATEWAY)
    reliable = talker.publisher("/beat", EMPTY, Qos.EVENTS)

    def said(publisher: Publisher, wanted: int) -> bool:
        publisher.publish({})
        return len(heard) >= wanted

    # Long enough for a look at the publishers.
    await until(lambda: said(reliable, 150), POLL_S)
    so_far = len(heard)
    hasty = talker.publisher("/beat", EMPTY, Qos.SENSOR)
    await until(lambda: said(hasty, so_far + 20), POLL_S)


async def test_both_events_of_a_transition_are_heard(link: Link) -> None:
    node = link.node("pilothouse", Lane.STATES)
    heard: list[str] = []
    loop_thread = threading.get_ident()
    where: set[tuple[str, bool]] = set()

    def pick(message: Any) -> str:  # noqa: ANN401
        where.add(("pick", threading.get_ident() == loop_thread))
        return str(message.goal_state.label)

    def take(label: str) -> None:
        where.add(("take", threading.get_ident() == loop_thread))
        heard.append(label)

    node.subscribe("/arm/transition_event", TRANSITION_EVENT, Qos.EVENTS, pick, take)
    state = node.client("/arm/get_state", GET_STATE)
    change = node.client("/arm/change_state", CHANGE_STATE)

    with nodes_process({"name": "arm"}):
        # Nothing is repeated for late comers; a node that has answered a client knows of all that
        # was made before the client.
        await (await ready(state)).call({}, WITHIN_S)
        assert await configure(await ready(change))
        await until(lambda: len(heard) == 2, POLL_S)

    assert heard == ["configuring", "inactive"]
    assert where == {("pick", False), ("take", True)}


async def test_a_silent_node_costs_no_more_than_the_deadline(link: Link) -> None:
    node = link.node("pilothouse", Lane.STATES)
    state = node.client("/arm/get_state", GET_STATE)
    with nodes_process({"name": "arm"}) as process:
        await ready(state)
        process.silence()

        with pytest.raises(TimeoutError):
            await state.call({}, BRIEFLY_S)

        process.go_on()
        # The response to what was given up comes now, and is nobody's.
        response = await state.call({}, WITHIN_S)
    assert response.current_state.label == "unconfigured"


async def test_a_call_that_is_cancelled_is_forgotten(link: Link) -> None:
    node = link.node("pilothouse", Lane.STATES)
    state = node.client("/nobody/get_state", GET_STATE)
    asking = asyncio.create_task(state.call({}, WITHIN_S))
    await asyncio.sleep(0)

    asking.cancel()
    await asyncio.wait([asking])

    assert asking.cancelled()


async def test_a_wrong_request_is_refused_before_it_is_sent(link: Link) -> None:
    node = link.node("pilothouse", Lane.STATES)
    change = node.client("/arm/change_state", CHANGE_STATE)

    with pytest.raises(InvalidValueError) as refused:
        await change.call({"transition": {"id": "configure"}}, WITHIN_S)

    assert refused.value.pointer == "/transition/id"


async def test_a_process_that_dies_is_missed_and_seen_again(link: Link) -> None:
    node = link.node("pilothouse", Lane.LIVELINESS)
    alive: list[bool] = []
    node.watch_liveliness("/arm/heartbeat", EMPTY, LEASE_S, alive.append)

    with nodes_process({"name": "arm", "heartbeat": True}) as process:
        await until(lambda: alive == [True], POLL_S)
        process.kill()
        await until(lambda: alive == [True, False], POLL_S)
        process.start()
        await until(lambda: alive == [True, False, True], POLL_S)


async def test_a_process_that_is_started_before_the_old_one_is_missed_is_heard(link: Link) -> None:
    node = link.node("pilothouse", Lane.LIVELINESS)
    alive: list[bool] = []
    node.watch_liveliness("/arm/heartbeat", EMPTY, LEASE_S, alive.append)

    with nodes_process({"name": "arm", "heartbeat": True}) as old:
        await until(lambda: alive == [True], POLL_S)
        with nodes_process({"name": "arm", "heartbeat": True}):
            await until(lambda: alive == [True, True], POLL_S)
            old.kill()
            await until(lambda: alive == [True, True, True], POLL_S)
        await until(lambda: alive == [True, True, True, False], POLL_S)


async def test_a_heartbeat_that_cannot_be_heard_is_told(
    link: Link, caplog: pytest.LogCaptureFixture
) -> None:
    watch = link.node("pilothouse", Lane.LIVELINESS)
    watch.watch_liveliness("/arm/heartbeat", EMPTY, LEASE_S, [].append)

    # With neither a lease nor automatic liveliness.
    link.node("arm", Lane.STATES).publisher("/arm/heartbeat", EMPTY, Qos.EVENTS)

    await until(lambda: "ignored a publisher that does not have" in caplog.text, POLL_S)
    assert "/arm/heartbeat" in caplog.text


@pytest.mark.parametrize("qos", Qos)
async def test_what_one_node_of_ours_publishes_another_hears(link: Link, qos: Qos) -> None:
    heard: list[str] = []
    # Latched is how a topic is published; who hears the last message asks for it so.
    link.node("hearing", Lane.SENSORS).subscribe(
        "/words", "std_msgs/msg/String", qos, lambda message: message.data, heard.append
    )
    publisher = link.node("saying", Lane.GATEWAY).publisher("/words", "std_msgs/msg/String", qos)

    async def said_and_heard() -> bool:
        publisher.publish({"data": "hello"})
        return "hello" in heard

    await until(said_and_heard, POLL_S)


async def test_late_comers_get_the_last_of_what_is_latched(link: Link) -> None:
    heard: list[str] = []
    publisher = link.node("saying", Lane.GATEWAY).publisher(
        "/words", "std_msgs/msg/String", Qos.LATCHED
    )
    publisher.publish({"data": "first"})
    publisher.publish({"data": "last"})

    link.node("late", Lane.SENSORS).subscribe(
        "/words", "std_msgs/msg/String", Qos.LATCHED, lambda message: message.data, heard.append
    )

    await until(lambda: heard == ["last"], POLL_S)


async def test_a_message_that_cannot_be_read_does_not_end_the_hearing(
    link: Link, caplog: pytest.LogCaptureFixture
) -> None:
    heard: list[int] = []

    def pick(message: Any) -> int:  # noqa: ANN401
        return int(message.data)

    link.node("hearing", Lane.SENSORS).subscribe(
        "/words", "std_msgs/msg/String", Qos.EVENTS, pick, heard.append
    )
    publisher = link.node("saying", Lane.GATEWAY).publisher(
        "/words", "std_msgs/msg/String", Qos.EVENTS
    )

    async def said_and_heard() -> bool:
        publisher.publish({"data": "one"})
        publisher.publish({"data": "1"})
        return 1 in heard

    await until(said_and_heard, POLL_S)
    assert "/words: messages are dropped" in caplog.text


@pytest.mark.parametrize(
    "name", ["no_such_msgs/msg/Thing", "std_msgs/msg/Thing", "os/msg/path", "Bool", "std_msgs/Bool"]
)
async def test_a_type_that_is_not_installed_is_named(link: Link, name: str) -> None:
    node = link.node("pilothouse", Lane.SENSORS)

    assert not link.has_type(name)
    with pytest.raises(UnknownTypeError, match=name):
        node.publisher("/thing", name, Qos.EVENTS)


async def test_types_that_are_installed_are_known(link: Link) -> None:
    assert link.has_type("std_msgs/msg/Bool")
    assert link.has_type(GET_STATE)


async def test_a_thread_that_breaks_down_is_not_silent(
    link: Link, caplog: pytest.LogCaptureFixture
) -> None:
    link.node("pilothouse", Lane.SENSORS)

    def break_down() -> None:
        raise OSError("out of file descriptors")

    link._spinners[Lane.SENSORS].executor.create_task(break_down)  # noqa: SLF001

    with pytest.raises(GraphFailedError, match="thread of the lane sensors failed: OSError"):
        await asyncio.wait_for(link.wait_failed(), WITHIN_S)
    assert "out of file descriptors" in caplog.text


async def test_a_middleware_that_hangs_keeps_nobody_from_ending(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    link = make_link()
    link.node("pilothouse", Lane.GATEWAY)
    goes_on, has_left = threading.Event(), threading.Event()
    shut_down = link.context.try_shutdown

    def hang() -> None:
        goes_on.wait()
        shut_down()
        has_left.set()

    monkeypatch.setattr(link.context, "try_shutdown", hang)
    monkeypatch.setattr("service.ros.graph.link._LEAVE_S", BRIEFLY_S)

    await link.close()
    is_gone = has_left.is_set()
    goes_on.set()

    assert not is_gone
    assert "the middleware hangs for 0.3 s" in caplog.text
    assert await asyncio.to_thread(has_left.wait, WITHIN_S)


async def test_after_it_is_closed_nothing_is_left_and_nothing_heard() -> None:
    heard: list[bool] = []
    cancelled = asyncio.Event()

    async def answer(_request: object) -> dict[str, object]:
        try:
            await asyncio.Event().wait()
        finally:
            cancelled.set()
        return {}

    link = make_link()
    for lane in Lane:
        link.node(f"ours_{lane.value}", lane)
    assert threads() == {"ros2 sender", *(f"ros2 {lane.value}" for lane in Lane)}
    node = link.node("pilothouse", Lane.GATEWAY)
    node.watch_liveliness("/arm/heartbeat", EMPTY, LEASE_S, heard.append)
    node.serve("/work", TRIGGER, answer)
    publisher = node.publisher("/words", "std_msgs/msg/String", Qos.EVENTS)
    client = await ready(node.client("/work", TRIGGER))
    asking = asyncio.create_task(client.call({}, BRIEFLY_S))
    with nodes_process({"name": "arm", "heartbeat": True}) as process:
        await until(lambda: heard == [True], POLL_S)
        await link.close()
        await link.close()
        process.kill()

        with pytest.raises(TimeoutError):
            await asking

    assert cancelled.is_set()
    assert threads() == set()
    assert heard == [True]
    assert not client.is_ready()
    publisher.publish({"data": "to nobody"})
    with pytest.raises(TimeoutError, match="closed"):
        await client.call({}, WITHIN_S)
