"""The image as `docker/build_here.sh` built it, run by buildah without an engine."""

import json
import os
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import httpx

IMAGE = "localhost/pilothouse"
UID = 10001
TOKEN = "a-token-of-the-image-test"
SECRET = "/run/secrets/pilothouse_token"
PATIENCE_S = 20.0

_CACHE = Path(os.environ.get("XDG_CACHE_HOME", "~/.cache")).expanduser() / "pilothouse"
# Another one is given by docker/with_podman_here.sh.
_ENVIRONMENT = {"CONTAINERS_STORAGE_CONF": str(_CACHE / "storage.conf")} | os.environ


def why_not() -> str | None:
    """Return why no container can run here; None: one can."""
    if os.getuid() != 0:
        return "buildah needs root here"
    if shutil.which("buildah") is None:
        return "buildah is not installed"
    found = subprocess.run(
        ["buildah", "inspect", "--type", "image", IMAGE],
        env=_ENVIRONMENT,
        capture_output=True,
        check=False,
    )
    return None if found.returncode == 0 else "the image is not built; see `make test-image`"


def own_command(*more: str) -> list[str]:
    """Return what an engine starts, with more arguments."""
    config = image_config()
    return [*config["Entrypoint"], *config["Cmd"], *more]


def free_port() -> int:
    """Return a port of this machine, whose network a container of buildah shares."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port: int = listener.getsockname()[1]
        return port


def image_config() -> dict[str, Any]:
    """Return what the image says of itself: `Entrypoint`, `Cmd`, `User`, `Healthcheck`, ..."""
    inspected = _buildah("inspect", "--type", "image", IMAGE)
    config: dict[str, Any] = json.loads(inspected)["Docker"]["config"]
    return config


class Container:
    """A container made of the image; what runs in it runs as the image's user.

    Args:
        name: Its name for buildah.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self.root = Path(_buildah("mount", name))
        """Its root file system, seen from outside."""

    def start(
        self,
        command: Sequence[str],
        *,
        environment: dict[str, str] | None = None,
        volumes: Sequence[str] = (),
    ) -> "Process":
        """Start a command.

        Args:
            command: Program and arguments.
            environment: Variables, besides those of the image.
            volumes: As `OUTSIDE:INSIDE:ro`.
        """
        options = [f"--env={name}={value}" for name, value in (environment or {}).items()]
        options += [f"--volume={volume}" for volume in volumes]
        return Process(
            ["buildah", "run", "--isolation", "chroot", *options, self._name, "--", *command]
        )

    def run(self, command: Sequence[str]) -> tuple[int, str]:
        """Run a command to its end; return the exit code and all that it said."""
        with self.start(command) as process:
            return process.ended()


@contextmanager
def container() -> Iterator[Container]:
    """Make a container and remove it again."""
    name = _buildah("from", "--pull-never", IMAGE)
    try:
        yield Container(name)
    finally:
        _buildah("rm", name)


@dataclass(frozen=True, slots=True)
class ServiceInContainer:
    """The service as the image starts it, ready."""

    process: "Process"
    url: str
    port: int
    ready_s: float
    """Seconds from the start of buildah to the first 200 of `/readyz`."""


@contextmanager
def serving(box: Container, folder: Path, *more: str) -> Iterator[ServiceInContainer]:
    """Run the image's own command with a token, on a port of its own as others may have 8000.

    Args:
        box: Where it runs.
        folder: For the file with the token.
        more: Arguments beside those of the image.
    """
    secret = folder / "token"
    secret.write_text(f"{TOKEN}\n")
    os.chown(secret, UID, UID)
    secret.chmod(0o400)
    port = free_port()
    url = f"http://127.0.0.1:{port}"
    with box.start(
        own_command("--port", str(port), *more),
        environment={"PILOTHOUSE_TOKEN_FILE": SECRET},
        volumes=[f"{secret}:{SECRET}:ro"],
    ) as process:
        yield ServiceInContainer(process, url, port, process.wait_until_ready(url))


class Process:
    """A process in a container, as a context that ends it.

    Args:
        command: With which buildah starts it.
    """

    def __init__(self, command: Sequence[str]) -> None:
        self._output: IO[str] = tempfile.TemporaryFile("w+")  # noqa: SIM115
        self.started_at = time.monotonic()
        """In s."""
        self._buildah = subprocess.Popen(
            command, env=_ENVIRONMENT, stdout=self._output, stderr=subprocess.STDOUT
        )

    def __enter__(self) -> "Process":
        return self

    def __exit__(self, *_: object) -> None:
        for pid in _descendants(self._buildah.pid):
            if _program(pid).startswith("python"):
                os.kill(pid, 9)
        self._buildah.wait(PATIENCE_S)
        self._output.close()

    @property
    def pid(self) -> int:
        """The number of the process itself, for this machine; it is there once it has begun."""
        return next(p for p in _descendants(self._buildah.pid) if _program(p).startswith("python"))

    def ended(self) -> tuple[int, str]:
        """Wait for the end; return the exit code and all that it said."""
        code = self._buildah.wait(PATIENCE_S)
        return code, self._said()

    def wait_until_ready(self, url: str) -> float:
        """Return after how many seconds `/readyz` answered 200.

        Raises:
            AssertionError: It ended, or was not ready in time.
        """
        while self._buildah.poll() is None:
            waited_s = time.monotonic() - self.started_at
            assert waited_s < PATIENCE_S, f"it is not ready:\n{self._said()}"
            try:
                if httpx.get(f"{url}/readyz").status_code == 200:
                    return waited_s
            except httpx.TransportError:
                # Polled, since nothing tells from outside that the port is open now.
                time.sleep(0.01)
        raise AssertionError(f"it ended:\n{self._said()}")

    def _said(self) -> str:
        self._output.seek(0)
        return self._output.read()


def _buildah(*arguments: str) -> str:
    done = subprocess.run(
        ["buildah", *arguments], env=_ENVIRONMENT, capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


def _descendants(pid: int) -> Iterator[int]:
    """Return the children of a process, theirs, and so on, nearest first."""
    # By the thread that started them, of which buildah has many.
    children = [
        int(child)
        for of_thread in Path(f"/proc/{pid}/task").glob("*/children")
        for child in of_thread.read_text().split()
    ]
    yield from children
    for child in children:
        yield from _descendants(child)


def _program(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/exe").readlink().name
    except OSError:
        return ""
