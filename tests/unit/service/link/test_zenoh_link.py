"""Who gets in, over real sockets; what every link keeps is in tests/conformance/test_link.py."""

import asyncio
import json
import logging
import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from unittest.mock import Mock

import pytest
import zenoh

from domain.computers import SUPERVISOR, ComputerName
from service.link import zenoh_link
from service.link.certificates import Certificates
from service.link.endpoints import Endpoints
from service.link.zenoh_link import ZenohLink
from service.link.zenoh_settings import configuration
from tests.support.certificates import certificates_in, make_certificates
from tests.support.container import free_port
from tests.support.links import RunningLink

BASE, ARM = ComputerName("base"), ComputerName("arm")
NAMES = (SUPERVISOR, BASE, ARM)
WHILE_S = 0.5
"""For so long somebody tries in vain; whoever gets in is heard in a tenth of it."""

needs_openssl = pytest.mark.skipif(
    shutil.which("openssl") is None, reason="openssl is not installed"
)


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_certificates(tmp_path_factory.mktemp("certificates"), *NAMES)


class Robot:
    """The computers of a robot that share a port of the supervisor."""

    def __init__(self, folder: Path | None, protocol: str = "quic") -> None:
        self.folder = folder
        self.protocol = protocol
        self.port = free_port()
        self.at = f"{protocol}/127.0.0.1:{self.port}"

    def link(self, name: ComputerName, folder: Path | None = None) -> ZenohLink:
        files = self.files(name, folder or self.folder)
        return ZenohLink(name, self.others(name), self.endpoints(name), files)

    def running(self, name: ComputerName, folder: Path | None = None) -> RunningLink:
        return RunningLink(name, self.link(name, folder))

    def running_without_access_control(self, name: ComputerName) -> RunningLink:
        link = self.link(name)
        del link._configuration["access_control"]  # noqa: SLF001  # only for the trial
        return RunningLink(name, link)

    def endpoints(self, name: ComputerName) -> Endpoints:
        if name == SUPERVISOR:
            return Endpoints((self.at,), ())
        return Endpoints((f"{self.protocol}/127.0.0.1:0",), (self.at,))

    def others(self, name: ComputerName) -> list[ComputerName]:
        return [other for other in NAMES if other != name]

    def files(self, name: ComputerName, folder: Path | None) -> Certificates | None:
        return None if folder is None else certificates_in(folder, name)

    @contextmanager
    def session_of_a_stranger(self, files: Certificates | None) -> Iterator[zenoh.Session]:
        """Open a session that keeps to no rules of its own."""
        configured = configuration(ARM, self.others(ARM), self.endpoints(ARM), files)
        configured.pop("access_control", None)
        session = zenoh.open(zenoh.Config.from_json5(json.dumps(configured)))
        try:
            yield session
        finally:
            session.close()  # type: ignore[no-untyped-call]


async def put_for_a_while(session: zenoh.Session, *keys: str) -> None:
    """Publish under all keys, for as long as it may take to get in."""
    loop = asyncio.get_running_loop()
    until = loop.time() + WHILE_S
    while loop.time() < until:
        for key in keys:
            await asyncio.to_thread(session.put, key, b"a lie")
        await asyncio.sleep(0.02)


AS_ANOTHER = (
    "pilothouse/supervisor/base/beat",
    "pilothouse/supervisor/base/message",
    "pilothouse/supervisor/*/message",
    "pilothouse/base/supervisor/message",
    "pilothouse/**",
)


@needs_openssl
async def test_a_certificate_of_another_authority_does_not_get_in(
    folder: Path, tmp_path: Path
) -> None:
    robot = Robot(folder)
    others = make_certificates(tmp_path, *NAMES)

    async with robot.running(SUPERVISOR) as supervisor, robot.running(ARM) as arm:
        async with robot.running(BASE, others) as impostor:
            for _ in range(20):
                impostor.send(SUPERVISOR, b"a lie")
                supervisor.send(BASE, b"a secret")
                await asyncio.sleep(WHILE_S / 20)
        await arm.reach(supervisor)

        assert supervisor.received == []
        assert impostor.received == []


@needs_openssl
async def test_nobody_gets_in_without_a_certificate(folder: Path) -> None:
    robot = Robot(folder)
    only_trusting = {"root_ca_certificate": str(folder / "ca.pem")}

    async with robot.running(SUPERVISOR) as supervisor:
        configured = configuration(ARM, [SUPERVISOR], robot.endpoints(ARM), None)
        configured["listen"] = {"endpoints": []}
        configured["transport"] = {"link": {"tls": only_trusting}}
        session = zenoh.open(zenoh.Config.from_json5(json.dumps(configured)))
        await put_for_a_while(session, "pilothouse/supervisor/arm/message")
        session.close()  # type: ignore[no-untyped-call]

        assert supervisor.received == []


@needs_openssl
@pytest.mark.parametrize("protocol", ["quic", "tls"])
async def test_a_device_cannot_speak_as_another_one_nor_as_the_supervisor(
    folder: Path, protocol: str
) -> None:
    robot = Robot(folder, protocol)

    async with robot.running(SUPERVISOR) as supervisor, robot.running(BASE) as base:
        await base.reach(supervisor)
        with robot.session_of_a_stranger(certificates_in(folder, ARM)) as session:
            await put_for_a_while(session, *AS_ANOTHER, "pilothouse/supervisor/arm/message")

        assert {sender for sender, _ in supervisor.received} == {ARM}
        assert base.received == []


@needs_openssl
async def test_without_access_control_a_device_could_speak_as_another_one(folder: Path) -> None:
    robot = Robot(folder)

    async with (
        robot.running_without_access_control(SUPERVISOR) as supervisor,
        robot.running_without_access_control(BASE) as base,
    ):
        await base.reach(supervisor)
        with robot.session_of_a_stranger(certificates_in(folder, ARM)) as session:
            await put_for_a_while(session, *AS_ANOTHER)

        assert {sender for sender, _ in supervisor.received} == {BASE}
        assert {sender for sender, _ in base.received} == {SUPERVISOR}


@needs_openssl
@pytest.mark.parametrize("is_controlled", [True, False])
async def test_a_device_cannot_overhear_what_is_for_another_one(
    folder: Path, is_controlled: bool
) -> None:
    robot = Robot(folder)
    running = robot.running if is_controlled else robot.running_without_access_control
    overheard: list[zenoh.Sample] = []

    async with running(SUPERVISOR) as supervisor, running(BASE) as base:
        await supervisor.reach(base)
        with robot.session_of_a_stranger(certificates_in(folder, ARM)) as session:
            session.declare_subscriber("pilothouse/**", overheard.append)
            for _ in range(20):
                supervisor.send(BASE, b"a secret")
                await asyncio.sleep(WHILE_S / 20)

    assert bool(overheard) is not is_controlled


@pytest.mark.parametrize("protocol", ["tcp", "tls", "quic"])
async def test_garbage_harms_nobody(protocol: str, request: pytest.FixtureRequest) -> None:
    if protocol != "tcp" and shutil.which("openssl") is None:
        pytest.skip("openssl is not installed")
    robot = Robot(None if protocol == "tcp" else request.getfixturevalue("folder"), protocol)

    async with robot.running(SUPERVISOR) as supervisor, robot.running(BASE) as base:
        await base.reach(supervisor)
        await asyncio.to_thread(send_garbage, protocol, robot.port)
        await base.reach(supervisor)
        base.send(SUPERVISOR, b"still here")

        assert await supervisor.hear(1) == [(BASE, b"still here")]


def send_garbage(protocol: str, port: int) -> None:
    garbage = [b"\x00" * 100, b"\xff" * 1_200, b"GET / HTTP/1.1\r\n\r\n", bytes(range(256)) * 4]
    for piece in garbage * 5:
        if protocol == "quic":
            with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as sending:
                sending.sendto(piece, ("127.0.0.1", port))
        else:
            with closing(socket.create_connection(("127.0.0.1", port), timeout=5.0)) as sending:
                sending.sendall(piece)


async def test_a_port_that_is_not_free_is_told_once_and_tried_again(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(zenoh_link, "_AGAIN_S", 0.02)
    robot = Robot(None, "tcp")

    with socket.create_server(("127.0.0.1", robot.port)), caplog.at_level(logging.ERROR):
        supervisor = await robot.running(SUPERVISOR).__aenter__()
        await asyncio.sleep(0.2)
    async with robot.running(BASE) as base:
        await base.reach(supervisor)
    await supervisor.stop()

    [told] = caplog.messages
    assert told.startswith(f"link: cannot listen at {robot.at}: ")


async def test_a_link_that_is_cancelled_while_it_opens_is_closed() -> None:
    robot = Robot(None, "tcp")

    for _ in range(5):
        async with robot.running(SUPERVISOR):
            pass

    with socket.create_server(("127.0.0.1", robot.port)):
        pass


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(zenoh_link, "_WATCH_S", 0.02)
    monkeypatch.setattr(zenoh_link, "_GIVE_UP_S", 0.4)


@pytest.mark.usefixtures("impatient")
async def test_a_device_that_zenoh_does_not_connect_again_opens_a_new_session() -> None:
    robot = Robot(None, "tcp")
    base = RunningLink(BASE, robot.link(BASE))
    link, good = base.link, configuration(BASE, robot.others(BASE), robot.endpoints(BASE), None)
    assert isinstance(link, ZenohLink)
    link._configuration = {**good, "connect": {"endpoints": []}}  # noqa: SLF001  # looks for nobody

    async with robot.running(SUPERVISOR) as supervisor, base:
        await asyncio.sleep(0.2)
        link._configuration = good  # noqa: SLF001
        await base.reach(supervisor)
        await supervisor.reach(base)
        for number in range(5):
            supervisor.send(BASE, b"%d" % number)

        assert await base.hear(5) == [(SUPERVISOR, b"%d" % number) for number in range(5)]


@needs_openssl
@pytest.mark.usefixtures("impatient")
async def test_a_device_that_reaches_nobody_over_quic_takes_tls(folder: Path) -> None:
    robot = Robot(folder)
    link = robot.link(SUPERVISOR)
    only_tls = {"endpoints": [f"tls/127.0.0.1:{robot.port}"]}
    link._configuration = {**link._configuration, "listen": only_tls}  # noqa: SLF001

    async with RunningLink(SUPERVISOR, link) as supervisor, robot.running(BASE) as base:
        await base.reach(supervisor)
        await supervisor.reach(base)


@pytest.mark.usefixtures("impatient")
async def test_a_supervisor_that_looks_for_others_keeps_its_session(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    opening = Mock(wraps=zenoh.open)
    monkeypatch.setattr(zenoh, "open", opening)
    at = f"tcp/127.0.0.1:{free_port()}"
    link = ZenohLink(SUPERVISOR, [BASE], Endpoints(("tcp/127.0.0.1:0",), (at,)))

    async with RunningLink(SUPERVISOR, link):
        await asyncio.sleep(1.0)

    assert opening.call_count == 1


@pytest.mark.usefixtures("impatient")
async def test_devices_hear_each_other_on_while_the_supervisor_is_down() -> None:
    robot = Robot(None, "tcp")

    async with robot.running(BASE) as base, robot.running(ARM) as arm:
        async with robot.running(SUPERVISOR) as supervisor:
            for other in (base, arm):
                await other.reach(supervisor)
            await base.reach(arm)
            await arm.reach(base)
        for number in range(40):
            base.send(ARM, b"%d" % number)
            arm.send(BASE, b"%d" % number)
            await asyncio.sleep(0.05)
        await base.reach(arm)
        await arm.reach(base)
        async with robot.running(SUPERVISOR) as supervisor:
            await base.reach(supervisor)
            await arm.reach(supervisor)

        assert arm.received == [(BASE, b"%d" % number) for number in range(40)]
        assert base.received == [(ARM, b"%d" % number) for number in range(40)]


def test_zenoh_is_needed_by_its_module_only() -> None:
    without = "import sys; sys.modules['zenoh'] = None; import service.link."

    for module, code in (("supervisor_end", 0), ("device_end", 0), ("zenoh_link", 1)):
        done = subprocess.run(
            [sys.executable, "-c", without + module], capture_output=True, text=True, check=False
        )
        assert done.returncode == code, done.stderr
    assert "import of zenoh halted" in done.stderr
