"""An emergency stop in ROS 2 while fifty real nodes report as fast as they can.

For `make bench-ros2`; needs ROS 2.
"""

import asyncio
import contextlib
import json
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from importlib import import_module
from importlib.util import find_spec

import pytest
import uvloop

from domain.actor import Actor
from domain.commands import Drive, NodeCommand
from domain.inputs import NodeReport, Reading, Readings, TaskRequest, VehicleReport
from domain.state_and_mode import DEFAULT_MODE, PartName
from domain.vehicle import Pose, VehicleState
from service.clock import Clock, MonotonicClock
from service.files.model_file import LoadedModel
from service.files.robot_file import read_robot_file
from service.ports import BackendMessage
from service.ros.backend.backend import Ros2Backend
from service.ros.graph.graph import RosGraph
from service.supervisor import Supervisor
from tests.ros2.support.isolation import isolate
from tests.support.bench import PROJECT, quantiles, report
from tests.support.big_model import FAST, PARAMETERS, SLOW, big_model
from tests.support.live_robot import make_onboard
from tests.support.manual_clock import ManualClock, settle
from tests.support.paths import straight
from tests.support.ros_graph import FakeGraph
from tests.support.ros_nodes import FakeNode, parameter_event

pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(find_spec("rclpy") is None, reason="needs ROS 2: make bench-ros2"),
]

NODES = 50
PROCESSES = 5
MODEL = big_model(NODES)
SUPPORT = PROJECT / "tests" / "ros2" / "support"
STOPS = 60
BURST = 5_000
BURSTS = 10
WITHIN_S = 30.0
PERIOD_S = 0.05
ROBOT_FILE = """
backend: ros2
signals: {stale_after_s: 0}
ros2: {signals: {estop: {topic: /estop, type: std_msgs/msg/Bool}}}
"""
OTHERS = Readings(
    (
        Reading("battery_level", 1.0),
        Reading("gps_accuracy", 10.0),
        Reading("signal_strength", "CONNECTED"),
        Reading("temperature", 20.0),
    ),
    "bench",
)


class Watched:
    """The backend, with a count of what nodes report and the times at which the vehicle stops."""

    simulation = None

    def __init__(self, backend: Ros2Backend) -> None:
        self.reports: Counter[PartName] = Counter()
        self.speed_mps = 0.0
        self.stopped_at_ns = 0
        self._backend = backend

    async def run(self, deliver: Callable[[BackendMessage], None]) -> None:
        def count_and_deliver(message: BackendMessage) -> None:
            if isinstance(message, NodeReport) and message.parameters:
                self.reports[message.node] += 1
            deliver(message)

        await self._backend.run(count_and_deliver)

    def send(self, command: NodeCommand | Drive, /) -> None:
        if isinstance(command, Drive):
            speed = command.command.speed_mps
            if self.speed_mps and not speed:
                self.stopped_at_ns = time.monotonic_ns()
            self.speed_mps = speed
        self._backend.send(command)


class Robot:
    """A robot that drives on and on, and a button that stops it."""

    def __init__(
        self, clock: Clock, graph: RosGraph, button: "subprocess.Popen[str] | None" = None
    ) -> None:
        robot = read_robot_file(ROBOT_FILE, MODEL)
        self.watched = Watched(Ros2Backend(MODEL, robot, graph, clock))
        loaded, onboard = LoadedModel(MODEL, (), ""), make_onboard(MODEL, clock.now())
        self.supervisor = Supervisor(loaded, onboard, clock, self.watched)
        self._button = button
        self._x_m = 0.0

    async def run(self) -> None:
        """Let the robot run, with a vehicle that does at once what it is told."""
        async with asyncio.TaskGroup() as tasks:
            tasks.create_task(self.supervisor.run())
            while True:
                self.submit_facts()
                await asyncio.sleep(PERIOD_S)

    def submit_facts(self) -> None:
        """Hand in readings without an error, and where the vehicle is."""
        speed = self.watched.speed_mps
        self._x_m += speed * PERIOD_S
        state = VehicleState(Pose(self._x_m, 0.0, 0.0), speed, 0.0)
        self.supervisor.submit(OTHERS)
        self.supervisor.submit(VehicleReport(state))

    def drive(self) -> None:
        """Begin to drive."""
        path = straight(2_000.0, 2.0)
        self.supervisor.submit(TaskRequest(path, 0, "pure_pursuit", 2.8, Actor("bench")))

    async def begin(self) -> None:
        """Begin to drive, once all nodes are there."""
        parts = self.supervisor.core.parts
        await until(lambda: all(view.reachable for view in parts().values()), 0.1)
        await self._push("release")
        await asyncio.sleep(0.5)
        self.drive()

    async def stop_s(self) -> float:
        """Return how long it takes from the press of the button until speed 0 is commanded."""
        watched = self.watched
        await until(lambda: watched.speed_mps > 0.1, 0.01)
        watched.stopped_at_ns = 0
        pressed_at_ns = await self._push("press")
        await until(lambda: watched.stopped_at_ns > 0, 0.001)
        taken_s = (watched.stopped_at_ns - pressed_at_ns) / 1e9
        await asyncio.sleep(0.1)
        await self._push("release")
        return taken_s

    async def _push(self, what: str) -> int:
        assert self._button is not None
        return await asyncio.to_thread(_tell, self._button, what)


async def until(condition: Callable[[], bool], pause_s: float) -> None:
    """Look again and again until a condition holds; a storm may take its time."""
    async with asyncio.timeout(WITHIN_S):
        while not condition():  # noqa: ASYNC110
            await asyncio.sleep(pause_s)


def _tell(button: "subprocess.Popen[str]", what: str) -> int:
    assert button.stdin is not None
    assert button.stdout is not None
    button.stdin.write(f"{what}\n")
    button.stdin.flush()
    return int(button.stdout.readline())


async def measured(robot: Robot, set_storm: Callable[[], None]) -> dict[str, dict[str, float]]:
    """Stop the robot again and again, first at rest and then in the storm."""
    run = asyncio.create_task(robot.run())
    try:
        await robot.begin()
        rows = {"at rest": await stops(robot)}
        set_storm()
        await asyncio.sleep(1.0)
        rows["in the storm"] = await stops(robot)
        assert len(robot.watched.reports) == NODES, "not every node was heard in the storm"
        return rows
    finally:
        run.cancel()
        await asyncio.gather(run, return_exceptions=True)


async def stops(robot: Robot) -> dict[str, float]:
    """Return how long stops take, and how much the nodes reported meanwhile."""
    robot.watched.reports.clear()
    began = time.monotonic()
    taken = [await robot.stop_s() for _ in range(STOPS)]
    counts = robot.watched.reports
    return {
        **quantiles(taken),
        "reports_a_second": round(sum(counts.values()) / (time.monotonic() - began)),
        "fewest_of_a_node": min((counts[node] for node in MODEL.nodes), default=0),
    }


def test_an_emergency_stop_in_a_storm_of_reports() -> None:
    isolate()
    with nodes() as storms, process("estop_button.py") as button:

        def set_storm() -> None:
            for storm in storms:
                assert storm.stdin is not None
                storm.stdin.write("go\n")
                storm.stdin.flush()

        async def work() -> dict[str, dict[str, float]]:
            graph = import_module("service.ros.graph.link").RosLink()
            return await measured(Robot(MonotonicClock(), graph, button), set_storm)

        with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
            rows = runner.run(work())
    report(
        "ros2_estop",
        f"Emergency stop beside {NODES} ROS 2 nodes",
        f"From when a button is about to publish on `/estop` in a process of its own until speed 0 "
        f"is commanded to a vehicle that drives, {STOPS} times at rest and {STOPS} times while "
        f"{NODES} nodes in {PROCESSES} processes publish their parameters as fast as they can, "
        "which changes their modes each time. Reports are those that reached the core.",
        rows,
        asked="an emergency stop never waits behind reports of nodes.",
        command="make bench-ros2",
    )


async def test_an_emergency_stop_behind_a_burst_of_reports() -> None:
    """In a graph in memory, so that nothing but our own queue is between button and vehicle."""
    clock = ManualClock()
    graph = FakeGraph(clock)
    for node in MODEL.nodes:
        FakeNode(graph, node, PARAMETERS[DEFAULT_MODE])
    robot = Robot(clock, graph)
    run = asyncio.create_task(robot.supervisor.run())
    await clock.advance(5.0)
    robot.submit_facts()
    graph.publish("/estop", {"data": False})
    await settle()
    robot.drive()
    taken = []
    for number in range(BURSTS):
        robot.submit_facts()
        await clock.advance(1.0)
        robot.submit_facts()
        assert robot.watched.speed_mps > 0
        for report_number in range(BURST):
            node = MODEL.nodes[list(MODEL.nodes)[report_number % NODES]].name
            mode = (FAST, SLOW)[(number + report_number // NODES) % 2]
            graph.publish("/parameter_events", parameter_event(node, PARAMETERS[mode]))
        pressed_at_ns = time.monotonic_ns()
        graph.publish("/estop", {"data": True})
        while robot.watched.speed_mps:  # noqa: ASYNC110
            await asyncio.sleep(0)
        taken.append((robot.watched.stopped_at_ns - pressed_at_ns) / 1e9)
        await settle()
        graph.publish("/estop", {"data": False})
        await clock.advance(1.0)
    assert sum(robot.watched.reports.values()) >= BURST * BURSTS
    run.cancel()
    await asyncio.gather(run, return_exceptions=True)
    report(
        "ros2_estop_burst",
        f"Emergency stop behind {BURST} reports",
        f"In a graph in memory, {NODES} nodes publish {BURST} changes of their modes in one turn "
        "of the event loop, and then the button is pressed: until speed 0 is commanded.",
        {f"{BURSTS} bursts": quantiles(taken)},
        asked="an emergency stop never waits behind reports of nodes.",
        command="make bench-ros2",
    )


@contextlib.contextmanager
def process(script: str, *arguments: str) -> "Iterator[subprocess.Popen[str]]":
    """Run a script of `tests/ros2/support` that says `ready`."""
    command = [sys.executable, str(SUPPORT / script), *arguments]
    running = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        assert running.stdout is not None
        assert running.stdout.readline() == "ready\n"
        yield running
    finally:
        running.kill()
        running.communicate()


@contextlib.contextmanager
def nodes() -> "Iterator[list[subprocess.Popen[str]]]":
    """Run the nodes of the model, spread over several processes."""
    names, share = list(MODEL.nodes), NODES // PROCESSES
    rounds = json.dumps([dict(PARAMETERS[mode]) for mode in (FAST, SLOW)])
    with contextlib.ExitStack() as running:
        yield [
            running.enter_context(
                process(
                    "storming_nodes.py",
                    json.dumps(
                        [
                            {"name": name, "parameters": dict(PARAMETERS[DEFAULT_MODE])}
                            for name in names[first : first + share]
                        ]
                    ),
                    rounds,
                )
            )
            for first in range(0, NODES, share)
        ]
