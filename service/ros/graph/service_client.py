"""A client of a service of ROS, for the event loop; imports no ROS."""

import asyncio
from collections.abc import Callable
from typing import Any

from service.ros.graph.answers import answer_within
from service.ros.graph.conversion import fill
from service.ros.graph.crossing import Crossing
from service.ros.graph.graph import Fields, Message
from service.ros.graph.sending import Turnstile


class ServiceClient:
    """A `Client` of rclpy."""

    def __init__(
        self,
        crossing: Crossing,
        turnstile: Turnstile,
        node: Any,  # noqa: ANN401
        kind: Any,  # noqa: ANN401
        client: Any,  # noqa: ANN401
    ) -> None:
        """Prepare.

        Args:
            crossing: Nothing is sent once it is closed.
            turnstile: Lets a few requests through in each pass of the event loop.
            node: Of rclpy, that has the client.
            kind: Type of the service.
            client: Of rclpy.
        """
        self._crossing = crossing
        self._turnstile = turnstile
        self._node = node
        self._kind = kind
        self._client = client

    def is_ready(self) -> bool:
        """Tell whether the graph knows a server."""
        return not self._crossing.closed and bool(self._client.service_is_ready())

    def servers(self) -> int:
        """Return how many servers the graph knows."""
        if self._crossing.closed:
            return 0
        return int(self._node.count_services(self._client.service_name))

    async def call(self, request: Fields, within_s: float) -> Message:
        """Send a request, and return the response.

        Raises:
            TimeoutError: There was none in time, or the link is closed.
            InvalidValueError: The fields do not fit the request type of the service.
        """
        await self._turnstile.wait_for_turn()
        # Filled in its turn, since fifty requests are made at once.
        message = self._kind.Request()
        fill(message, request)
        self._check_open()
        return await self._response_to(self._client.call_async(message), within_s)

    async def call_large(self, make: Callable[[], Fields], within_s: float) -> Message:
        """Send a large request from another thread, and return the response.

        Raises:
            TimeoutError: There was none in time, or the link is closed.
            InvalidValueError: The fields do not fit the request type of the service.
        """
        self._check_open()
        asked = await asyncio.to_thread(self._ask, make)
        return await self._response_to(asked, within_s)

    def _ask(self, make: Callable[[], Fields]) -> Any:  # noqa: ANN401  # a future of rclpy
        message = self._kind.Request()
        fill(message, make())
        return self._client.call_async(message)

    def _check_open(self) -> None:
        if self._crossing.closed:
            raise TimeoutError("the link to ROS 2 is closed")

    async def _response_to(self, asked: Any, within_s: float) -> Message:  # noqa: ANN401
        response: asyncio.Future[Message] = asyncio.get_running_loop().create_future()
        # Awaiting the future of rclpy would busy-wait.
        asked.add_done_callback(lambda done: self._crossing.post(_settle, response, done.result()))
        try:
            return await answer_within(response, within_s)
        finally:
            self._client.remove_pending_request(asked)


def _settle(response: asyncio.Future[Message], message: Message) -> None:
    if not response.done():
        response.set_result(message)
