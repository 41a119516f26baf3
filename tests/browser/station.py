"""What a test of the page works with: the service as a process, and an ear for complaints."""

import json
import math
import os
import resource
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import ConsoleMessage, Page

START_WITHIN_S = 90.0
HEALTHY_WITHIN_S = 20.0
CHROMIUM = Path("/usr/bin/chromium")
CHROMIUM_ARGUMENTS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
# Whose holds nobody else releases.
OWNED = ("error", "vehicle")
HEALTHY = {
    "battery_level": 0.9,
    "estop": False,
    "gps_accuracy": 20,
    "signal_strength": "CONNECTED",
    "temperature": 30,
}


@dataclass
class Service:
    """`pilothouse serve` on a port that stays the same over restarts."""

    port: int
    output: IO[bytes]
    arguments: tuple[str, ...] = ()
    """Further ones of `pilothouse serve`: a model, a robot file."""
    data: str = ":memory:"
    """Where it keeps what survives it."""
    _process: subprocess.Popen[bytes] | None = field(default=None, init=False)

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def start(self) -> None:
        command = Path(sys.executable).with_name("pilothouse")
        arguments = [str(command), "serve", "--port", str(self.port), "--data", self.data]
        arguments += self.arguments
        self._process = subprocess.Popen(arguments, stdout=self.output, stderr=self.output)
        end = time.monotonic() + START_WITHIN_S
        while not self._is_ready():
            if self._process.poll() is not None or time.monotonic() > end:
                self.output.seek(0)
                pytest.fail(f"the service did not start: {self.output.read().decode()}")
            time.sleep(0.05)

    def kill(self) -> None:
        """End the process as a power cut would."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            self._process = None

    def break_storage(self) -> None:
        """Let each write to a file fail, as a broken disk does."""
        self._limit_files(0)

    def mend_storage(self) -> None:
        """Let files be written again."""
        self._limit_files(resource.RLIM_INFINITY)

    def _limit_files(self, size: int) -> None:
        assert self._process is not None
        limits = (size, resource.RLIM_INFINITY)
        resource.prlimit(self._process.pid, resource.RLIMIT_FSIZE, limits)

    def request(self, method: str, path: str, body: object = None) -> dict[str, Any]:
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(f"{self.url}{path}", data, method=method)
        with urllib.request.urlopen(request, timeout=10) as answer:
            result: dict[str, Any] = json.loads(answer.read() or "{}")
        return result

    def pose(self) -> dict[str, float]:
        """Return where the vehicle is: `x_m`, `y_m`, `yaw_rad`."""
        pose: dict[str, float] = self.request("GET", "/vehicle")["pose"]
        return pose

    def track_ahead(self, length_m: int, *, scans: bool = False) -> bytes:
        """Return the CSV of a straight track that begins where the vehicle is, a point each 0.5 m.

        It leads through the heading of the vehicle; `scans`: its third column is no heading.
        """
        pose = self.pose()
        yaw = pose["yaw_rad"]
        points = [
            (
                pose["x_m"] + 0.5 * n * math.cos(yaw),
                pose["y_m"] + 0.5 * n * math.sin(yaw),
                37.0 * n % 360.0 if scans else yaw,
            )
            for n in range(2 * length_m + 1)
        ]
        return "".join(f"{x:.4f},{y:.4f},{third:.4f}\n" for x, y, third in points).encode()

    def make_healthy(self) -> None:
        """Bring stop, signals, holds and task to where they are after a start."""
        self.request("DELETE", "/tasks/current")
        for hold in self.request("GET", "/holds")["items"]:
            if hold["owner"] not in OWNED and not hold["owner"].startswith("reaction:"):
                self.request("DELETE", f"/holds/{hold['owner']}")
        self.request("PUT", "/emergency_stop", {"engaged": False, "reason": "next test"})
        for signal, value in HEALTHY.items():
            self.request("PATCH", f"/mock/{signal}", {"value": value, "publishing": True})
        self._end_reactions()
        end = time.monotonic() + HEALTHY_WITHIN_S
        while self.request("GET", "/system_state")["state"] != "IDLE":
            assert time.monotonic() < end, self.request("GET", "/system_state")
            time.sleep(0.02)
        self._see_all_errors()

    def _end_reactions(self) -> None:
        """Acknowledge the reactions that hold until somebody does."""
        for item in self.request("GET", "/reactions")["items"]:
            if item["until"] == "acknowledged" and item["state"] == "acting":
                path = f"{self._path_of(item['part'])}/reactions/{item['reaction']}"
                self.request("POST", f"{path}/acknowledge")

    def _see_all_errors(self) -> None:
        """Acknowledge what is over, and announce all errors again."""
        for error in self.request("GET", "/errors?open=true")["items"]:
            path = f"/errors/{error['error']}"
            if error["part"] is not None:
                path = f"{self._path_of(error['part'])}{path}"
            self.request("POST", f"{path}/acknowledge")
            self.request("DELETE", f"{path}/shelf")

    def _path_of(self, part: str) -> str:
        systems = [system["name"] for system in self.request("GET", "/systems")["items"]]
        return f"/{'systems' if part in systems else 'nodes'}/{part}"

    def _is_ready(self) -> bool:
        try:
            with urllib.request.urlopen(f"{self.url}/readyz", timeout=1) as answer:
                return bool(answer.status == 200)
        except (urllib.error.URLError, ConnectionError, TimeoutError):
            return False


@contextmanager
def serving(
    folder: Path, arguments: tuple[str, ...] = (), *, keeps: bool = False
) -> Iterator[Service]:
    """Let a service run.

    Args:
        folder: Gets its output, and what it keeps.
        arguments: Further ones of `pilothouse serve`.
        keeps: Whether it keeps anything beyond its own process.
    """
    data = str(folder / "data") if keeps else ":memory:"
    with (folder / "output").open("w+b") as output:
        service = Service(free_port(), output, arguments, data)
        try:
            service.start()
            yield service
        finally:
            service.kill()


@dataclass
class Complaints:
    """What the browser says that no operator should have to read: errors, and refused content."""

    messages: list[str] = field(default_factory=list)

    def watch(self, page: "Page") -> None:
        page.on("console", self._note)
        page.on("pageerror", lambda error: self.messages.append(str(error)))

    def _note(self, message: "ConsoleMessage") -> None:
        if message.type in ("error", "warning"):
            self.messages.append(message.text)


def free_port() -> int:
    """Return a port that stays free while the service is down.

    Those from 32768 on the kernel gives to whoever asks for any; each process has its own range,
    of this run and of another one on the same machine.
    """
    begin = 20_000 + 100 * (os.getpid() % 120)
    for port in range(begin, begin + 100):
        with socket.socket() as probe:
            # As the service does, which may follow another one on the same port.
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            with suppress(OSError):
                probe.bind(("127.0.0.1", port))
                return port
    pytest.fail("no port is free")
