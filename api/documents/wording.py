"""What the documents say of the interface as a whole."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from api.streaming.client_input import TOPICS

DESCRIPTION = "\n".join(
    (
        "Pilothouse supervises a robot: it knows the lifecycle states and modes of its systems and"
        " nodes, changes them, judges the robot's health from its signals, and drives its waypoint"
        " task.",
        "",
        "* Names of fields carry the unit: `_s`, `_m`, `_rad`, `_mps`. Times end in `_at` and are"
        ' RFC 3339 in UTC with milliseconds. Lists are `{"items": [...]}`.',
        "* A body is read as JSON whatever its content type, unless a web page sends it. Unknown"
        " fields are refused.",
        "* Whatever is refused or fails is answered with a problem (RFC 9457), whose `code` is"
        " stable. A refusal changes nothing.",
        "* A request for a change is answered before the robot has changed: 202 with the change and"
        " its address. With `?wait=SECONDS` the answer comes when it has ended; with"
        " `?dry_run=true` it is the plan, and nothing is done.",
        "",
        "Frames and events are streamed over a WebSocket at `/ws`, which"
        " [asyncapi.json](/asyncapi.json) describes.",
    )
)
"""A line for each paragraph, since a page would break them where the source does."""

LICENSE = MappingProxyType({"name": "Apache License 2.0", "identifier": "Apache-2.0"})

TOKEN = (
    "The value of `PILOTHOUSE_TOKEN`, where the service was started with one. Without one it asks"
    " for none."
)

TAGS: Mapping[str, str] = MappingProxyType(
    {
        "systems": "Systems: what they are in, inferred from their parts, and changes of it.",
        "nodes": "Nodes: what they report, their parameters, and changes of both.",
        "changes": "What became of the changes that were asked for, step by step.",
        "health": "Signals, the state of the robot that follows from them, and the emergency stop.",
        "reactions": "What the robot does while something is so, and whether it may.",
        "devices": "The other computers of the robot: who owns what, and who is heard.",
        "drive": "The vehicle, its waypoint task, and who holds it.",
        "events": "What happened, in order.",
        "model": "The model of the robot's systems and nodes, and the check of any other one.",
        "inference": "What the robot would be in, if targets and nodes were as told.",
        "simulation": "The same core in virtual time, fed with a scenario.",
        "service": "How the service itself fares.",
    }
)
"""Groups of operations, in the order in which they are shown."""

STREAM = "\n".join(
    (
        "What happens to the robot as it happens, in text messages with one JSON object each. The"
        " `type` of a message tells what it is.",
        "",
        "* `state` frames come at 20 Hz, and at once when the state of the robot changes in"
        " between. A slow client skips frames and is told how many.",
        "* `event` messages are in order and without loss: `after` and `epoch` in the address go on"
        " behind an event that is known, and what is not kept any more is told in a `gap`.",
        "* No ages are sent: a client computes them from `received_at`.",
        "",
        "Where the service was started with a token, the first message of a client is `auth`."
        " Requests are described by [openapi.json](/openapi.json).",
    )
)

ROSBRIDGE = (
    "The topics and services that Pilothouse offers to ROS, in rosbridge v2 as JSON: `subscribe`,"
    " `unsubscribe`, `advertise`, `unadvertise`, `publish`, `call_service`, `set_level`, and the"
    " services `/rosapi/topics`, `/rosapi/services` and a few more. Its clients are roslibpy and"
    " roslib; neither end needs ROS. Where the service was started with a token, the handshake"
    " holds `Authorization: Bearer`, or the first message is"
    ' `{"op": "auth", "token": "..."}`.'
)

STREAM_QUERY: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        "topics": {
            "type": "string",
            "description": f"Some of {', '.join(TOPICS)}, with commas between; left out: all",
            "examples": ["system_state,events"],
        },
        "after": {
            "type": "integer",
            "minimum": 0,
            "description": "Id of the last event known; left out: only new events are sent",
        },
        "epoch": {
            "type": "string",
            "description": "Epoch of that id, as in the event; it may be of an earlier run",
        },
    }
)
"""What a client may ask for in the address of the stream."""
