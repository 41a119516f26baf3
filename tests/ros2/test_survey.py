"""What is wrong in a real graph is found: ends of topics that do not match, and doubled names."""

from collections.abc import Sequence

import pytest

from domain.graph_terms import GraphFault, GraphFaultKind
from service.ros.graph.conversion import fields_of
from service.ros.graph.graph import Lane, Qos
from tests.ros2.support.links import POLL_S, Link, a_link
from tests.support.waiting import until

pytestmark = pytest.mark.ros2

BOOL, EMPTY = "std_msgs/msg/Bool", "std_msgs/msg/Empty"


async def until_found(link: Link, *expected: tuple[GraphFaultKind, str]) -> Sequence[GraphFault]:
    """Look again and again until exactly this is wrong; return it."""
    found: list[GraphFault] = []

    async def is_it() -> bool:
        found[:] = await link.look()
        return [(fault.kind, fault.name) for fault in found] == [*expected]

    await until(is_it, POLL_S)
    return found


async def test_a_best_effort_publisher_of_a_reliable_subscription_is_found_and_its_end(
    link: Link,
) -> None:
    link.node("pilothouse", Lane.SENSORS).subscribe("/button", BOOL, Qos.EVENTS, fields_of, print)
    await until_found(link)

    async with a_link() as other:
        other.node("driver", Lane.SENSORS).publisher("/button", BOOL, Qos.SENSOR)
        (fault,) = await until_found(link, (GraphFaultKind.QOS, "/button"))
        assert fault.reason == (
            "no message arrives from /driver: Best effort publisher and reliable subscription"
        )

    await until_found(link)


async def test_a_subscriber_that_wants_more_than_we_publish_is_found(link: Link) -> None:
    link.node("pilothouse", Lane.SENSORS).publisher("/cmd", BOOL, Qos.COMMANDS)

    async with a_link() as other:
        base = other.node("base", Lane.SENSORS)
        base.subscribe("/cmd", BOOL, Qos.LATCHED, fields_of, print)

        await until_found(link, (GraphFaultKind.QOS, "/cmd"))


async def test_a_publisher_of_another_type_is_found(link: Link) -> None:
    link.node("pilothouse", Lane.SENSORS).subscribe("/button", BOOL, Qos.SENSOR, fields_of, print)

    async with a_link() as other:
        other.node("driver", Lane.SENSORS).publisher("/button", EMPTY, Qos.EVENTS)

        (fault,) = await until_found(link, (GraphFaultKind.TYPE, "/button"))
        assert fault.reason == f"/driver publishes {EMPTY}, and Pilothouse has {BOOL}"


async def test_two_nodes_of_one_name_are_found(link: Link) -> None:
    link.node("pilothouse", Lane.SENSORS)

    async with a_link() as one, a_link() as another:
        for each in (one, another):
            each.node("left/arm", Lane.SENSORS)

        await until_found(link, (GraphFaultKind.DUPLICATE, "/left/arm"))
