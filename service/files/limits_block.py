"""What can be set about how much clients may ask of the service."""

from typing import Annotated, TypeAlias

from pydantic import Field

from service.files.robot_settings import SettingsBlock

KIB = 1_024
MIB = 1_024 * KIB

_MessageBytes: TypeAlias = Annotated[int, Field(ge=KIB, le=MIB)]
_FileBytes: TypeAlias = Annotated[int, Field(ge=KIB, le=16 * MIB)]


class LimitsBlock(SettingsBlock):
    """How much clients may ask of the service. Without effect in simulations, where nobody asks.

    What makes the robot safe is never refused for being asked too often: the emergency stop, holds,
    the end of a task, readings.
    """

    json_bytes: _MessageBytes = 256 * KIB
    """Largest JSON body, in bytes, where none of the following holds. It is read by the loop that
    drives the robot, at some 3 ms for 256 KiB."""
    model_bytes: _FileBytes = 8 * MIB
    """Largest body that may hold a model, in bytes: a check, an inference, a simulation."""
    waypoints_bytes: _FileBytes = 16 * MIB
    """Largest body that holds waypoints, in bytes; 16 MiB are 100,000 of them with all digits."""
    message_bytes: _MessageBytes = 64 * KIB
    """Largest message of a client over the WebSocket, in bytes."""
    stream_clients: Annotated[int, Field(ge=1, le=100_000)] = 2_500
    """So many clients the stream has at most; a further one is told to come later."""
    requests_per_s: Annotated[int, Field(ge=1, le=1_000_000)] = 1_000
    """Requests per second of one client address; twice as many may come at once."""
