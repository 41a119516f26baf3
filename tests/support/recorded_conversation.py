"""What two computers of this release say to each other, as a later release will hear it.

A release that says more adds a folder: `python -m tests.support.recorded_conversation`.
"""

import base64
import json
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from domain.commands import AnswerOrder
from domain.computers import SUPERVISOR, ComputerName
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.link.messages import Beat, Message
from domain.timebase import Instant
from service.link.wire import decode, encode
from tests.support.linked_pair import BASE, DRIVE, LinkedRobot

FILE = Path(__file__).parents[1] / "data" / "link" / "v1" / "conversation.jsonl"


class Line(NamedTuple):
    """One message, and when it was sent."""

    at: Instant
    sender: ComputerName
    to: ComputerName
    message: Message


def conversation() -> list[Line]:
    """Return a conversation: a device connects, configures its node as told, and is stopped."""
    robot = LinkedRobot()
    robot.run(2)
    request = robot.order()
    robot.run(0.1)
    robot.tell(robot.base, AnswerOrder(request, DRIVE, accepted=True))
    robot.note(NodeReport(DRIVE, LifecycleState.INACTIVE))
    robot.run(1)
    robot.engage(robot.base, "b1")
    robot.run(1)
    robot.engage(robot.base)
    robot.engage(robot.supervisor, "s1")
    robot.run(1)
    return [
        Line(at, SUPERVISOR if to == BASE else BASE, to, message) for at, to, message in robot.sent
    ]


def write() -> None:
    """Record a conversation of this release, for later ones to understand."""
    lines = [
        {
            "at": at,
            "from": sender,
            "to": to,
            "data": base64.b64encode(encode(message)).decode(),
        }
        for at, sender, to, message in conversation()
    ]
    FILE.write_text("".join(json.dumps(line) + "\n" for line in lines))


def read() -> Iterator[Line]:
    """Yield the lines of the recorded conversation."""
    for text in FILE.read_text().splitlines():
        line = json.loads(text)
        message = decode(base64.b64decode(line["data"]))
        yield Line(line["at"], ComputerName(line["from"]), ComputerName(line["to"]), message)


def ids_of(computer: ComputerName, lines: list[Line]) -> list[str]:
    """Return the incarnation and the sessions that a computer used, in their order."""
    ids: dict[str, None] = {}
    for line in lines:
        if line.sender == computer:
            ids[line.message.incarnation] = None
            if isinstance(line.message, Beat) and line.message.session is not None:
                ids[line.message.session] = None
    return list(ids)


if __name__ == "__main__":
    write()
