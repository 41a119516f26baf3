"""A stream of a robot that changes fast: `python -m tests.support.page_bench.frame_server PORT`.

It takes `hello` and the complete frame of the service on PORT, gives it 200 signals, and then tells
every 50 ms that 5 % of the parts and of the signals have changed. The service itself could do that
as well, but then robot, load and browser would share the cores of a small machine.
"""

import asyncio
import json
import random
import sys
from datetime import UTC, datetime
from typing import Any

import websockets

from tests.support.page_bench.announcing import announce

SIGNALS = 200
PERIOD_S = 0.05
SHARE = 0.05


class ChangingRobot:
    """Frames of a robot, the first of them complete."""

    def __init__(self, hello: dict[str, Any], complete: dict[str, Any]) -> None:
        self.hello = hello
        known = complete["signals"]["battery_level"]
        signals = {f"signal_{number:03}": dict(known) for number in range(SIGNALS)}
        self.complete = {**complete, "signals": {**complete["signals"], **signals}}
        self._chance = random.Random(1)
        self._parts = [name for name, part in complete["parts"].items() if part["kind"] == "node"]
        self._signals = list(signals)

    def change(self, seq: int, at: str) -> dict[str, Any]:
        """Return the next frame."""
        system_state = {**self.complete["system_state"], "seq": seq, "at": at}
        return {
            "type": "state",
            "seq": seq,
            "at": at,
            "skipped": 0,
            "system_state": system_state,
            "parts": {name: self._other_part(name) for name in self._some(self._parts)},
            "signals": {name: self._other_signal(name, at) for name in self._some(self._signals)},
        }

    def _some(self, names: list[str]) -> list[str]:
        return self._chance.sample(names, round(len(names) * SHARE))

    def _other_part(self, name: str) -> dict[str, Any]:
        part = self.complete["parts"][name]
        mode = self._chance.choice(["__DEFAULT__", "FAST", "SLOW"])
        part["actual"] = {**part["actual"], "state": "active", "mode": mode}
        return dict(part)

    def _other_signal(self, name: str, at: str) -> dict[str, Any]:
        signal = self.complete["signals"][name]
        signal.update(value=self._chance.random(), at=at)
        return dict(signal)


async def take_beginning(url: str) -> ChangingRobot:
    """Return a robot that begins as the one that is streamed at `url`."""
    async with websockets.connect(url, max_size=None) as stream:
        hello = json.loads(await stream.recv())
        complete: dict[str, Any] = {}
        while "parts" not in complete:
            complete = json.loads(await stream.recv())
    return ChangingRobot(hello, complete)


async def _main(port: int) -> None:
    robot = await take_beginning(f"ws://127.0.0.1:{port}/ws")

    def now() -> str:
        return datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")

    async def serve(client: websockets.ServerConnection) -> None:
        seq = robot.complete["seq"]
        await client.send(json.dumps(robot.hello))
        await client.send(json.dumps({**robot.complete, "at": now()}))
        while True:
            await asyncio.sleep(PERIOD_S)
            seq += 1
            await client.send(json.dumps(robot.change(seq, now())))

    async with websockets.serve(serve, "127.0.0.1", 0) as server:
        announce(server.sockets)
        await asyncio.get_running_loop().create_future()


if __name__ == "__main__":
    asyncio.run(_main(int(sys.argv[1])))
