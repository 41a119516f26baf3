"""A robot of several computers, each a process of its own: its supervisor and its devices."""

import asyncio
import socket
import time
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import httpx

from tests.support.process import ServiceProcess, device, service
from tests.support.shared import PROJECT

MODEL = PROJECT / "service" / "example" / "actuation.yaml"
DEVICES = """\
  base: {parts: [drive_base]}
  arm: {parts: [manipulator]}
"""
Shown: TypeAlias = dict[str, tuple[str, str | None]]
"""State and mode by part."""

_POLL_S = 0.02
PATIENCE_S = 20.0


def free_port() -> int:
    """Return a port of TCP that nothing listens at now."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


class RobotOfComputers:
    """Starts and kills its computers; closes all at the end.

    Args:
        folder: For its files.
        devices: The block `devices` of its robot file, as YAML.
        more: More of the robot file.
        link: The block `link` of its robot file; None: without certificates, at a free port.
    """

    def __init__(
        self, folder: Path, devices: str = DEVICES, more: str = "", link: str | None = None
    ) -> None:
        self.folder = folder
        self.file = folder / "robot.yaml"
        link = link or f"{{connect: [tcp/127.0.0.1:{free_port()}]}}"
        self.file.write_text(f"name: lawn\nlink: {link}\ndevices:\n{devices}{more}")
        self._stack = ExitStack()

    def supervisor(self, *arguments: str) -> "Computer":
        """Start the supervisor; without a folder it remembers nothing."""
        return self._started(service(*self._options(arguments)))

    def device(self, name: str, *arguments: str) -> "Computer":
        """Start a device; without a folder it remembers nothing."""
        return self._started(device(name, *self._options(arguments)))

    def all(self, *arguments: str) -> tuple["Computer", "Computer", "Computer"]:
        """Start the supervisor with its arguments, the base and the arm, all at once."""
        supervisor = partial(self.supervisor, *arguments)
        starts = (supervisor, partial(self.device, "base"), partial(self.device, "arm"))
        with ThreadPoolExecutor() as threads:
            supervisor, base, arm = threads.map(lambda start: start(), starts)
        return supervisor, base, arm

    def _options(self, arguments: tuple[str, ...]) -> tuple[str, ...]:
        return (str(MODEL), "--robot", str(self.file), *_data(arguments))

    def _started(self, process: AbstractContextManager[ServiceProcess]) -> "Computer":
        running = self._stack.enter_context(process)
        http = httpx.Client(base_url=running.url, timeout=30)
        return Computer(running, self._stack.enter_context(http))

    def close(self) -> None:
        """Kill all that runs."""
        self._stack.close()


def _data(arguments: tuple[str, ...]) -> tuple[str, ...]:
    return arguments if "--data" in arguments else (*arguments, "--data", ":memory:")


@contextmanager
def robot_of_computers(
    folder: Path, devices: str = DEVICES, more: str = "", link: str | None = None
) -> Iterator[RobotOfComputers]:
    """Give a robot none of whose computers runs yet, and kill those that do at the end."""
    robot = RobotOfComputers(folder, devices, more, link)
    try:
        yield robot
    finally:
        robot.close()


class Computer:
    """One computer of the robot, through its HTTP interface."""

    def __init__(self, process: ServiceProcess, http: httpx.Client) -> None:
        self.process = process
        self._http = http

    @property
    def greeting(self) -> str:
        """Return what it printed when it began."""
        return self.process.greeting

    def kill(self) -> None:
        """End its process as a power cut would."""
        self.process.kill()

    def get(self, path: str) -> Any:  # noqa: ANN401
        """Return what is at a path."""
        answer = self._http.get(path)
        assert answer.status_code == 200, answer.text
        return answer.json()

    def ask(self, path: str, status: int = 200, method: str = "POST", **body: object) -> Any:  # noqa: ANN401
        """Ask for something, wait for its end, and see how it is answered."""
        way = f"{path}?wait=20" if method == "POST" and "/emergency" not in path else path
        answer = self._http.request(method, way, json=body)
        assert answer.status_code == status, answer.text
        return answer.json() if answer.content else None

    def order(self, path: str, **body: object) -> Any:  # noqa: ANN401
        """Ask for something, and do not wait for its end."""
        answer = self._http.post(path, json=body)
        assert answer.status_code == 202, answer.text
        return answer.json()

    def text(self, path: str) -> str:
        """Return what is at a path that is no JSON."""
        return self._http.get(path).text

    def actual(self) -> Shown:
        """Return the actual state and mode of every part."""
        return {
            part["name"]: (part["actual"]["state"], part["actual"]["mode"])
            for part in self._parts()
        }

    def targets(self) -> Shown:
        """Return the target of every part that has one."""
        return {
            part["name"]: (part["target"]["state"], part["target"]["mode"])
            for part in self._parts()
            if part["target"] is not None
        }

    def devices(self) -> Mapping[str, Any]:
        """Return the devices by name."""
        return {item["device"]: item for item in self.get("/devices")["items"]}

    def device_states(self) -> dict[str, str]:
        """Return how the connection to each device is."""
        return {name: item["state"] for name, item in self.devices().items()}

    def active_errors(self) -> set[str]:
        """Return the names of the errors that are active."""
        errors = self.get("/errors")["items"]
        return {item["error"] for item in errors if item["state"] == "active"}

    async def until(self, condition: Any, within_s: float = PATIENCE_S) -> float:  # noqa: ANN401
        """Wait until something holds; return how many seconds that took."""
        begun = time.monotonic()
        while not await asyncio.to_thread(condition):
            waited_s = time.monotonic() - begun
            assert waited_s < within_s, f"not within {within_s} s: {self.actual()}"
            await asyncio.sleep(_POLL_S)
        return time.monotonic() - begun

    async def until_connected(self, *names: str) -> float:
        """Wait until devices are connected, and their nodes known."""

        def is_it() -> bool:
            states = self.device_states()
            return all(states[name] == "connected" for name in names)

        return await self.until(is_it)

    def _parts(self) -> list[dict[str, Any]]:
        return [*self.get("/systems")["items"], *self.get("/nodes")["items"]]
