"""A session on this machine over a real ssh, in which a person types."""

import asyncio
import getpass
import os
import shlex
import shutil
import socket
import subprocess
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from pathlib import Path

SSHD = shutil.which("sshd", path="/usr/sbin:/usr/local/sbin")
HAS_SSH = SSHD is not None and shutil.which("ssh") is not None
_RETRIES = 50
_RETRY_S = 0.1


class SshSession:
    """A shell at the other end of ssh, without echo and prompt."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process

    async def enter(self, command: Sequence[str]) -> None:
        """Type a command and Enter; it runs as long as it takes."""
        assert self._process.stdin is not None
        self._process.stdin.write(shlex.join(command).encode() + b"\n")
        await self._process.stdin.drain()

    async def until(self, words: str) -> None:
        """Read what the other end prints, up to a line with these words."""
        assert self._process.stdout is not None
        while words.encode() not in (line := await self._process.stdout.readline()):
            assert line, f"the session ended before it said {words!r}"


@asynccontextmanager
async def ssh_session(folder: Path) -> AsyncIterator[SshSession]:
    """Log in over ssh as who runs the tests, by a key and a server of this session alone.

    Args:
        folder: For keys; empty.
    """
    key, host_key = folder / "key", folder / "host_key"
    for path in (key, host_key):
        quiet = ("-q", "-t", "ed25519", "-N", "", "-f", str(path))
        await _run("ssh-keygen", *quiet)
    shutil.copy(key.with_suffix(".pub"), folder / "authorized_keys")
    with socket.create_server(("127.0.0.1", 0)) as found:
        port = found.getsockname()[1]
    server = await asyncio.create_subprocess_exec(*_sshd(folder, host_key, port))
    try:
        shell = await _logged_in(key, port)
        try:
            yield SshSession(shell)
        finally:
            shell.kill()
            await shell.wait()
    finally:
        server.terminate()
        await server.wait()


def _sshd(folder: Path, host_key: Path, port: int) -> list[str]:
    assert SSHD is not None
    if os.geteuid() == 0:
        # sshd insists on this folder then, and some images have none.
        Path("/run/sshd").mkdir(exist_ok=True)
    options = {
        "ListenAddress": "127.0.0.1",
        "AuthorizedKeysFile": str(folder / "authorized_keys"),
        "PasswordAuthentication": "no",
        "PermitRootLogin": "prohibit-password",
        "PidFile": "none",
        "StrictModes": "no",
        "UsePAM": "no",
    }
    said = [part for name, value in options.items() for part in ("-o", f"{name}={value}")]
    return [SSHD, "-D", "-e", "-q", "-f", "/dev/null", "-p", str(port), "-h", str(host_key), *said]


async def _logged_in(key: Path, port: int) -> asyncio.subprocess.Process:
    """Return a shell on a terminal of the other end, once it answers."""
    for _ in range(_RETRIES):
        shell = await asyncio.create_subprocess_exec(
            *("ssh", "-tt", "-q", "-p", str(port), "-i", str(key)),
            *("-o", "StrictHostKeyChecking=no", "-o", "UserKnownHostsFile=/dev/null"),
            f"{getpass.getuser()}@127.0.0.1",
            "stty -echo; PS1= exec sh",
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        session = SshSession(shell)
        try:
            await session.enter(["echo", "ready"])
            await session.until("ready")
        except (AssertionError, BrokenPipeError, ConnectionResetError):
            await shell.wait()
            await asyncio.sleep(_RETRY_S)
        else:
            return shell
    raise AssertionError("nobody could log in over ssh")


async def _run(*command: str) -> None:
    process = await asyncio.create_subprocess_exec(*command)
    assert await process.wait() == 0, command
