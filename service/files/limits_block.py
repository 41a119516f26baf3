"""Settings of limits on what clients may request."""

from typing import Annotated, TypeAlias

from pydantic import Field

from service.files.settings_block import SettingsBlock

KIB = 1_024
MIB = 1_024 * KIB

_MessageBytes: TypeAlias = Annotated[int, Field(ge=KIB, le=MIB)]
_FileBytes: TypeAlias = Annotated[int, Field(ge=KIB, le=16 * MIB)]


class LimitsBlock(SettingsBlock):
    """Limits on what clients may request. Without effect in simulations, which have no clients.

    Requests that make the robot safe are never rejected by the rate limit: the emergency stop,
    holds, the cancel of a task, readings.
    """

    json_bytes: _MessageBytes = 256 * KIB
    """Largest JSON body, in bytes, if none of the following limits applies. The event loop that
    drives the robot parses it, at some 3 ms for 256 KiB."""
    model_bytes: _FileBytes = 8 * MIB
    """Largest body that can contain a model, in bytes: check, inference, simulation."""
    waypoints_bytes: _FileBytes = 16 * MIB
    """Largest body with waypoints, in bytes; 16 MiB suffice for 100,000 of them with all digits."""
    message_bytes: _MessageBytes = 64 * KIB
    """Largest WebSocket message from a client, in bytes."""
    stream_clients: Annotated[int, Field(ge=1, le=100_000)] = 2_500
    """Largest number of stream clients; further ones are told to try again later."""
    requests_per_s: Annotated[int, Field(ge=1, le=1_000_000)] = 1_000
    """Requests per second from one client address; a burst may have twice as many."""
