"""What it costs to have the nodes on other computers, and how soon all of them are known."""

import http.client
import json
import sys
import time
from pathlib import Path

import pytest

from tests.support.asker import Asker, asking
from tests.support.bench import Row, quantiles, report
from tests.support.big_model import big_model_text
from tests.support.measured_service import PILOTHOUSE, MeasuredService, measured_service, module
from tests.support.process_usage import first_and_last_core
from tests.support.robot_of_computers import free_port, robot_of_computers

pytest.importorskip("zenoh", reason="the extra `link` is not installed")
pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(sys.platform != "linux", reason="reads /proc"),
    pytest.mark.timeout(300),
]

CHANGES = 200
AT_ONCE = "{configure_s: 0, activate_s: 0, deactivate_s: 0, set_parameters_s: 0}"
NODES = f"nodes: {{drive_base: {AT_ONCE}, manipulator: {AT_ONCE}}}\n"
"""Nodes that obey at once, so that what is left is ours."""
MODES = ("SLOW", "FAST")
DEVICES, NODES_EACH = 20, 50
SETTLE_S, SECONDS = 3.0, 10.0


async def test_what_a_request_over_the_link_takes_longer(tmp_path: Path) -> None:
    local_file = tmp_path / "local.yaml"
    local_file.write_text(NODES)
    with (
        robot_of_computers(tmp_path, more=NODES) as robot,
        measured_service((*PILOTHOUSE, "--robot", str(local_file))) as local,
    ):
        supervisor, _, _ = robot.all()
        await supervisor.until_connected("base", "arm")
        remote = supervisor.process.url.removeprefix("http://")
        async with asking(remote) as over_link, asking(local.host) as beside:
            times = await _times(over_link, beside)
    report(
        "devices_requests",
        "Requests over the link between computers",
        f"{CHANGES} changes between two modes of a node that responds at once, until the change "
        "has succeeded: of a node on a device in a process of its own, over zenoh on loopback, and "
        "in turn of the same node of a service that simulates it itself.",
        {name: quantiles(taken) for name, taken in times.items()},
        asked="the 99th percentile is at most 5 ms above that of the node beside it.",
    )


async def _times(over_link: Asker, beside: Asker) -> dict[str, list[float]]:
    """Return what changes took, s."""
    times: dict[str, list[float]] = {"on a device": [], "beside it": []}
    for number in range(CHANGES):
        mode = f'{{"mode": "{MODES[number % 2]}"}}'
        for name, asker in (("on a device", over_link), ("beside it", beside)):
            took = (await asker.ask("POST /nodes/drive_base/mode?wait=5", mode))[1]
            times[name].append(took)
    # The first one configures and activates the node.
    return {name: taken[1:] for name, taken in times.items()}


def test_how_soon_a_thousand_nodes_on_twenty_devices_are_known(tmp_path: Path) -> None:
    model, robot, counted = (tmp_path / name for name in ("model.yaml", "robot.yaml", "bytes"))
    model.write_text(big_model_text(DEVICES * NODES_EACH))
    robot.write_text(_robot_of_many())
    first, last = first_and_last_core()
    many = module("tests.support.many_devices", str(model), str(robot), str(counted))
    serve = (*PILOTHOUSE, str(model), "--robot", str(robot), "--data", ":memory:")
    with measured_service(many, core=last), measured_service(serve, core=first) as service:
        begun = time.perf_counter()
        while not _knows_all(service):
            assert time.perf_counter() < begun + 60, "not all nodes are known"
            time.sleep(0.02)
        known_s = time.perf_counter() - begun
        time.sleep(SETTLE_S)
        at, before, sent = time.perf_counter(), service.usage.cpu_s(), _sent(counted)
        time.sleep(SECONDS)
        took = time.perf_counter() - at
        row: Row = {
            "known_s": round(known_s, 2),
            "CPU_percent": round(100 * (service.usage.cpu_s() - before) / took, 1),
            "reports_Mbit_per_s": round(
                8e-6 * (_sent(counted)["messages"] - sent["messages"]) / took, 3
            ),
            "beats_Mbit_per_s": round(8e-6 * (_sent(counted)["beats"] - sent["beats"]) / took, 3),
            **service.usage.figures(),
        }
    report(
        "devices",
        "Many devices",
        f"{DEVICES} devices of {NODES_EACH} nodes each, all in one process but with a core and a "
        "connection over zenoh each, on a core of its own; `known_s` is from the moment at which "
        "`pilothouse serve` says that it listens until every node is known; then its CPU as the "
        f"share of a core, and what all devices send, over {SECONDS:g} s in which nothing happens.",
        {"at rest": row},
        asked="known within 3 s, at most 15 % of a core, reports of at most 2 Mbit/s.",
    )


def _robot_of_many() -> str:
    lines = [f"link: {{connect: [tcp/127.0.0.1:{free_port()}]}}", "devices:"]
    for number in range(DEVICES):
        begin = number * NODES_EACH
        nodes = ", ".join(f"node_{n}" for n in range(begin, begin + NODES_EACH))
        lines.append(f"  device{number}: {{parts: [{nodes}]}}")
    return "\n".join([*lines, ""])


def _knows_all(service: MeasuredService) -> bool:
    devices = _get(service, "/devices")["items"]
    if not all(item["state"] == "connected" for item in devices):
        return False
    return bool(_get(service, "/systems/system_3_0")["reachable"])


def _get(service: MeasuredService, path: str) -> dict[str, list[dict[str, object]]]:
    connection = http.client.HTTPConnection(service.host, timeout=20)
    try:
        connection.request("GET", path)
        found: dict[str, list[dict[str, object]]] = json.loads(connection.getresponse().read())
        return found
    finally:
        connection.close()


def _sent(counted: Path) -> dict[str, int]:
    sent: dict[str, int] = json.loads(counted.read_text())
    return sent
