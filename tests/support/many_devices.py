"""All devices of a robot in one process, for benches: `python -m tests.support.many_devices`.

Each has its own core, its own simulated nodes and its own connection over zenoh. The first argument
is the model, the second the robot file, the third a file for how many bytes of messages all of them
have sent so far.
"""

import asyncio
import json
import sys
from pathlib import Path

import uvloop

from domain.computers import ComputerName
from service.clock import continuous_clock
from service.files.model_file import LoadedModel, load_model
from service.files.robot_file import RobotSettings, read_robot_file
from service.link.place import place_in
from service.link.port import DeliverMessage, Link, LinkCounts
from service.link.zenoh_link import ZenohLink
from tests.support.linked_robot import make_computer

_EVERY_S = 0.5


class CountingLink:
    """A link that counts the bytes of what it sends."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self.beats = self.messages = 0
        """Bytes so far."""

    async def run(self, deliver: DeliverMessage) -> None:
        """Run the link."""
        await self._link.run(deliver)

    def send(self, to: ComputerName, message: bytes, *, may_be_lost: bool) -> None:
        """Count, and send."""
        if may_be_lost:
            self.beats += len(message)
        else:
            self.messages += len(message)
        self._link.send(to, message, may_be_lost=may_be_lost)

    def counts(self) -> LinkCounts:
        """Return what was dropped."""
        return self._link.counts()


async def _run(loaded: LoadedModel, robot: RobotSettings, counted: Path) -> None:
    clock = continuous_clock()
    links: list[CountingLink] = []
    async with asyncio.TaskGroup() as tasks:
        for name in robot.devices:
            own = robot.model_copy(update={"device": name})
            place = place_in(own)
            assert place is not None
            link = CountingLink(ZenohLink(place.name, place.others, place.endpoints))
            links.append(link)
            device, _ = make_computer(loaded.model, own, link, clock)
            tasks.create_task(device.run(), name=name)
        print("page  http://127.0.0.1:0/\nCtrl-C", flush=True)
        while True:
            await asyncio.sleep(_EVERY_S)
            bytes_ = {
                "beats": sum(link.beats for link in links),
                "messages": sum(link.messages for link in links),
            }
            beside = counted.with_suffix(".new")
            beside.write_text(json.dumps(bytes_))
            beside.replace(counted)


if __name__ == "__main__":
    model_file, robot_file, counted = map(Path, sys.argv[1:])
    loaded = load_model(model_file)
    robot = read_robot_file(robot_file.read_text(), loaded.model)
    with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
        runner.run(_run(loaded, robot, counted))
