"""A robot of real processes: the example nodes and `pilothouse serve --backend ros2`."""

import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from typing import Any, TypeAlias

import httpx

from tests.support.process import COMMAND, ServiceProcess, service
from tests.support.shared import PROJECT
from tests.support.waiting import until

NODES = PROJECT / "examples" / "ros2" / "nodes"
SLOW_MANIPULATOR = Path(__file__).with_name("slow_manipulator.py")
POLL_S = 0.02

Shown: TypeAlias = dict[str, tuple[str, str | None]]
"""State and mode by part."""


class NodeProcess:
    """One node in a process of its own.

    Args:
        script: What to run.
        arguments: Of the script.
        environment: More variables, as `NAME=value`.
    """

    def __init__(self, script: Path, *arguments: str, environment: Sequence[str] = ()) -> None:
        self._command = ["env", *environment, sys.executable, str(script), *arguments]
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it, for the first time or again."""
        self._process = subprocess.Popen(
            self._command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )

    def kill(self) -> None:
        """End it with SIGKILL: it has no time to say anything."""
        if self._process is not None:
            self._process.send_signal(signal.SIGKILL)
            self._process.wait()


@contextmanager
def node(
    script: Path | str, *arguments: str, start: bool = True, environment: Sequence[str] = ()
) -> Iterator[NodeProcess]:
    """Run a node as long as the context lasts.

    Args:
        script: A file, or the name of an example node.
        arguments: Of the script.
        start: Whether to start it at once; otherwise somebody calls `start`.
        environment: More variables, as `NAME=value`.
    """
    file = NODES / f"{script}.py" if isinstance(script, str) else script
    process = NodeProcess(file, *arguments, environment=environment)
    if start:
        process.start()
    try:
        yield process
    finally:
        process.kill()


class RosRobot:
    """A service that supervises real nodes, through its HTTP interface.

    Args:
        process: The service.
        http: A client of it.
    """

    def __init__(self, process: ServiceProcess, http: httpx.AsyncClient) -> None:
        self.process = process
        self.http = http

    async def get(self, path: str) -> Any:  # noqa: ANN401
        """Return what a successful GET answers."""
        answer = await self.http.get(path)
        assert answer.status_code == httpx.codes.OK, answer.text
        return answer.json()

    async def begin(self, path: str, **body: str) -> str:
        """Ask for a change; return its path without waiting for its end."""
        answer = await self.http.post(path, json=body)
        assert answer.status_code == httpx.codes.ACCEPTED, answer.text
        return answer.headers["location"]

    async def do(self, path: str, **body: str) -> None:
        """Ask for a change and see it succeed."""
        answer = await self.http.post(f"{path}?wait=30", json=body)
        assert answer.status_code == httpx.codes.OK, answer.text

    async def ended(self, change: str) -> Any:  # noqa: ANN401
        """Wait for the end of a change that was begun, and return it."""

        async def is_over() -> bool:
            return bool((await self.get(change))["status"] != "running")

        await until(is_over, POLL_S)
        return await self.get(change)

    async def actual(self) -> Shown:
        """Return state and mode of every part."""
        return await self._shown("actual")

    async def targets(self) -> Shown:
        """Return the target of every part; every one needs to have one."""
        return await self._shown("target")

    async def until_reachable(self, *nodes: str) -> None:
        """Wait until nodes are heard of."""
        for name in nodes:
            await self.until_part(f"/nodes/{name}", reachable=True)

    async def until_part(self, path: str, **wanted: object) -> Any:  # noqa: ANN401
        """Wait until a part is shown with these values; return how it is shown."""

        async def is_so() -> bool:
            part = await self.get(path)
            return all(part[key] == value for key, value in wanted.items())

        await until(is_so, POLL_S)
        return await self.get(path)

    async def until_state(self, name: str, state: str) -> None:
        """Wait until a node is in a lifecycle state."""

        async def is_in() -> bool:
            part = await self.get(f"/nodes/{name}")
            return bool(part["actual"]["state"] == state)

        await until(is_in, POLL_S)

    async def events(self, *kinds: str) -> list[dict[str, Any]]:
        """Return the events of these kinds, in order."""
        answer = await self.get("/events?after=0&limit=1000")
        return [event for event in answer["items"] if event["kind"] in kinds]

    async def _shown(self, what: str) -> Shown:
        parts = [
            part for kind in ("systems", "nodes") for part in (await self.get(f"/{kind}"))["items"]
        ]
        return {part["name"]: (part[what]["state"], part[what]["mode"]) for part in parts}


@asynccontextmanager
async def ros_robot(*arguments: str, environment: Sequence[str] = ()) -> AsyncIterator[RosRobot]:
    """Run `pilothouse serve --backend ros2 --mock-signals` as long as the context lasts.

    Args:
        arguments: More options.
        environment: More variables, as `NAME=value`.
    """
    command = ("env", *environment, *COMMAND)
    options = ("--backend", "ros2", "--mock-signals", *arguments)
    with service(*options, command=command) as process:
        async with httpx.AsyncClient(base_url=process.url, timeout=40) as http:
            yield RosRobot(process, http)
