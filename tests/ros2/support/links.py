"""Links to ROS 2, which can be imported only where it is."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib import import_module
from typing import Any, TypeAlias

from service.ros.graph.graph import Client
from tests.support.waiting import until

WITHIN_S = 5.0
POLL_S = 0.02

Link: TypeAlias = Any
"""A RosLink."""


def make_link() -> Link:
    """Return a link that the test closes."""
    return import_module("service.ros.graph.link").RosLink()


@asynccontextmanager
async def a_link() -> AsyncIterator[Link]:
    """Return a link that is closed at the end of the context."""
    made = make_link()
    try:
        yield made
    finally:
        await made.close()


async def ready(client: Client) -> Client:
    """Return a client once there is somebody who can be asked."""
    await until(client.is_ready, POLL_S)
    return client
