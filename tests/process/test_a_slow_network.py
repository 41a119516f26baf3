"""A supervisor and a device over a network that is slow and mixes up the order of packets."""

import asyncio
import shutil
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from tests.support.certificates import make_certificates
from tests.support.robot_of_computers import (
    Computer,
    free_port,
    robot_of_computers,
)
from tests.support.slow_relay import SlowRelay

pytest.importorskip("zenoh", reason="the extra `link` is not installed")
pytestmark = [
    pytest.mark.timeout(180),
    pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is not installed"),
]

SHORTEST_S, LONGEST_S = 0.15, 0.25
"""Of each packet, in each direction: 200 ms, and every fourth is overtaken."""
STOPPED_WITHIN_S = LONGEST_S + 1.0
LOST_WITHIN_S = 1.8 + LONGEST_S
SEEN_S = 0.5
"""What a busy machine and the asking take on top."""
CONNECTED_WITHIN_S = 60.0
DEVICES = "  base: {parts: [drive_base]}\n"
NODE = "/nodes/drive_base"


@pytest.fixture(scope="module")
def relay() -> Iterator[SlowRelay]:
    """The network: where devices look for the supervisor, which listens at another address."""
    port = free_port()
    with SlowRelay(("127.0.0.2", port), ("127.0.0.1", port), SHORTEST_S, LONGEST_S) as relay:
        yield relay


@pytest.fixture(scope="module")
def running(
    tmp_path_factory: pytest.TempPathFactory, relay: SlowRelay
) -> Iterator[tuple[Computer, Computer]]:
    folder = tmp_path_factory.mktemp("robot")
    files = make_certificates(folder / "certificates", "supervisor", "base")
    link = (
        f"{{listen: ['quic/127.0.0.1:{relay.port}'], connect: ['quic/127.0.0.2:{relay.port}'], "
        f"ca: {files}/ca.pem, certificate: '{files}/{{name}}.pem', key: '{files}/{{name}}.key'}}"
    )
    with robot_of_computers(folder, DEVICES, link=link) as robot, ThreadPoolExecutor() as threads:
        base = threads.submit(robot.device, "base")
        yield robot.supervisor(), base.result()


@pytest.fixture
async def computers(running: tuple[Computer, Computer]) -> tuple[Computer, Computer]:
    """The supervisor and the device, connected and in FAST."""
    supervisor, _ = running
    await supervisor.until(lambda: state(supervisor) == "connected", CONNECTED_WITHIN_S)
    supervisor.ask(f"{NODE}/mode", mode="FAST")
    return running


async def test_a_slow_link_is_no_fault_and_what_is_asked_over_it_is_done_once(
    computers: tuple[Computer, Computer], relay: SlowRelay
) -> None:
    supervisor, base = computers
    begun, begun_base = newest(supervisor), newest(base)

    for mode in ("SLOW", "FAST") * 4:
        supervisor.ask(f"{NODE}/mode", mode=mode)
        assert supervisor.actual()["drive_base"] == ("active", mode)
        assert base.actual()["drive_base"] == ("active", mode)

    print(
        f"{relay.overtaken} of {relay.carried} packets were overtaken; {round_trip_s(supervisor)} s"
    )
    assert relay.overtaken > relay.carried / 10, "the order was mixed up"
    assert round_trip_s(supervisor) > 2 * SHORTEST_S
    for kind in ("device.late", "device.lost", "device.connected"):
        assert events(supervisor, begun, kind) == []
    taken = [order["action"] for order in events(base, begun_base, "order.taken")]
    assert taken == ["set_parameters"] * 8


async def test_a_stop_reaches_the_other_computer_over_a_slow_link(
    computers: tuple[Computer, Computer],
) -> None:
    for pressed, other in (computers, computers[::-1]):
        pressed.ask("/emergency_stop", method="PUT", engaged=True, reason="a test")
        took_s = await other.until(lambda other=other: is_stopped(other))

        print(f"stopped {took_s:.2f} s after it was pressed")
        assert took_s < STOPPED_WITHIN_S
        computers[0].ask("/emergency_stop", method="PUT", engaged=False)
        for each in computers:
            await each.until(lambda each=each: not is_stopped(each))


async def test_what_the_network_kept_during_a_cut_and_delivers_later_is_not_carried_out(
    computers: tuple[Computer, Computer], relay: SlowRelay
) -> None:
    supervisor, base = computers
    begun = newest(base)

    relay.keep()
    kept_from = time.monotonic()
    change = supervisor.order(f"{NODE}/mode", mode="SLOW")
    await supervisor.until(lambda: state(supervisor) == "lost")
    lost_s = time.monotonic() - kept_from
    await base.until(lambda: base.get("/devices")["this"]["supervisor"] == "lost")
    relay.let_pass()
    await supervisor.until(lambda: state(supervisor) == "connected", CONNECTED_WITHIN_S)
    await asyncio.sleep(LONGEST_S + 1.0)  # Nothing comes: that can only be waited for.

    print(f"lost {lost_s:.2f} s after nothing passed any more")
    assert lost_s < LOST_WITHIN_S + SEEN_S
    assert events(base, begun, "order.taken") == []
    assert base.actual()["drive_base"] == ("active", "FAST")
    assert supervisor.get(f"/changes/{change['id']}")["status"] in ("failed", "timed_out")


def state(supervisor: Computer) -> str:
    """Return how its connection to the device is."""
    return supervisor.device_states()["base"]


def is_stopped(computer: Computer) -> bool:
    """Tell whether the robot is stopped, as a computer knows it."""
    return bool(computer.get("/emergency_stop")["engaged"])


def round_trip_s(supervisor: Computer) -> float:
    """Return how long a beat and its echo are under way."""
    name = 'pilothouse_device_round_trip_seconds{device="base"} '
    lines = supervisor.text("/metrics").splitlines()
    return next(float(line.removeprefix(name)) for line in lines if line.startswith(name))


def newest(computer: Computer) -> int:
    """Return the id of the newest event."""
    return int(computer.get("/events?limit=1&before=1000000000")["items"][-1]["id"])


def events(computer: Computer, after: int, kind: str) -> list[dict[str, Any]]:
    """Return the data of the events of a kind since one."""
    found = computer.get(f"/events?after={after}&kind={kind}&limit=1000")["items"]
    return [event["data"] for event in found]
