import asyncio
import logging
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from api.cli import ros_monitor as module
from api.cli.monitor.monitor import MakeFeed
from api.cli.monitor.store import Json
from api.cli.ros_monitor import GraphFeed, Warnings, ros_monitor
from api.client.outcomes import NoAnswerError
from api.serving.misuse import MisuseError
from domain.lifecycle import LifecycleState, Transition
from service.ros.interface.message_fields import mode_event
from tests.support.manual_clock import ManualClock, settle
from tests.support.models import (
    ACTUATION,
    ARM,
    BASE,
    FAST,
    PERFORMANCE,
    STRONG,
    actuation_model,
)
from tests.support.ros_graph import FakeGraph
from tests.support.ros_nodes import FakeNode

S, T = LifecycleState, Transition
MODEL = "models/actuation.yaml"
EXAMPLE = "service/example/actuation.yaml"


class Robot:
    """The robot of D4.8 in a graph in memory, in PERFORMANCE, and a feed that observes it."""

    def __init__(self, *missing: str) -> None:
        self.clock = ManualClock()
        self.graph = FakeGraph(self.clock, missing)
        self.warnings = Warnings()
        self.news = 0
        model = actuation_model()
        self.feed = GraphFeed(MODEL, model, self.graph, self.clock, self.warnings, self._note_news)
        self.running: asyncio.Task[None] | None = None

    def _note_news(self) -> None:
        self.news += 1

    def start_nodes(self, *, arm: bool = True) -> FakeNode:
        base = FakeNode(self.graph, BASE, {"max_speed": 0.9, "controller": "MPC"})
        base.state = S.ACTIVE
        if arm:
            FakeNode(self.graph, ARM, {"max_torque": 0.2}).state = S.ACTIVE
        return base

    async def begin(self, *, once: bool = False, announced: bool = True) -> None:
        self.running = asyncio.create_task(self.feed.run_once() if once else self.feed.run())
        await settle()
        if announced:
            self.announce()

    def announce(self) -> None:
        for part, mode in ((ACTUATION, PERFORMANCE), (BASE, FAST), (ARM, STRONG)):
            message = mode_event(self.clock.now(), None, mode)
            self.graph.publish(f"/{part}/mode_request_info", message)

    async def end(self) -> None:
        if self.running is not None:
            self.running.cancel()
            await asyncio.wait([self.running])

    def failure(self) -> BaseException | None:
        assert self.running is not None
        return self.running.exception()

    @property
    def has_ended(self) -> bool:
        return self.running is not None and self.running.done()

    def part(self, name: str) -> Json:
        return (self.feed.watch.robot.parts or {})[name]

    def labels(self) -> dict[str, tuple[str, str | None]]:
        parts = self.feed.watch.robot.parts or {}
        return {name: (p["actual"]["state"], p["actual"]["mode"]) for name, p in parts.items()}


@pytest.fixture
async def robot() -> AsyncIterator[Robot]:
    made = Robot()
    yield made
    await made.end()


async def test_it_tells_all_parts_at_once_and_what_changes_later(robot: Robot) -> None:
    base = robot.start_nodes()
    await robot.begin()
    assert list(robot.feed.watch.robot.parts or {}) == ["actuation", "drive_base", "manipulator"]

    await robot.clock.advance(2.0)
    assert robot.labels() == {
        "actuation": ("active", "PERFORMANCE"),
        "drive_base": ("active", "FAST"),
        "manipulator": ("active", "STRONG"),
    }

    base.move(T.DEACTIVATE)
    await robot.clock.advance(0.1)
    assert robot.labels()["drive_base"] == ("inactive", None)
    assert robot.part("drive_base")["target"] == {"state": "active", "mode": "FAST"}
    assert robot.part("actuation")["deviation_since_at"] is not None


async def test_it_says_which_model_and_which_domain(
    robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "42")
    named = Robot()
    await named.begin()

    assert named.feed.watch.robot.model == MODEL
    assert named.feed.watch.view().url == "ROS 2, domain 42"
    await named.end()


async def test_where_nothing_happens_it_tells_that_twice_a_second(robot: Robot) -> None:
    robot.start_nodes()
    await robot.begin()
    await robot.clock.advance(10.0)
    before, at = robot.news, robot.feed.watch.robot.at
    await robot.clock.advance(10.0)

    assert robot.news - before == 20
    assert robot.feed.watch.robot.at != at


async def test_the_picture_is_whole_once_all_nodes_were_heard_and_nothing_more_comes(
    robot: Robot,
) -> None:
    robot.start_nodes()
    await robot.begin()
    await robot.clock.advance(0.9)
    assert not robot.feed.watch.robot.is_whole

    await robot.clock.advance(2.0)
    assert robot.feed.watch.robot.is_whole


async def test_the_picture_waits_for_targets_that_are_heard_late(robot: Robot) -> None:
    robot.start_nodes()
    await robot.begin(announced=False)
    await robot.clock.advance(2.0)
    assert not robot.feed.watch.robot.is_whole

    robot.announce()
    await robot.clock.advance(1.1)
    assert robot.feed.watch.robot.is_whole
    assert robot.part("drive_base")["target"] == {"state": "active", "mode": "FAST"}


async def test_the_picture_is_whole_after_a_while_though_nobody_announces_targets(
    robot: Robot,
) -> None:
    robot.start_nodes()
    await robot.begin(announced=False)
    await robot.clock.advance(2.9)
    assert not robot.feed.watch.robot.is_whole

    await robot.clock.advance(0.2)
    assert robot.feed.watch.robot.is_whole


async def test_once_ends_with_what_is_known_though_a_node_is_absent(robot: Robot) -> None:
    robot.start_nodes(arm=False)
    await robot.begin(once=True)
    await robot.clock.advance(4.5)
    assert not robot.has_ended

    await robot.clock.advance(1.0)
    assert robot.has_ended
    assert robot.failure() is None
    assert robot.labels()["drive_base"] == ("active", "FAST")
    assert not robot.part("manipulator")["reachable"]
    assert robot.graph.closed


async def test_once_without_any_node_says_what_may_be_wrong(robot: Robot) -> None:
    await robot.begin(once=True)
    await robot.clock.advance(6.0)

    assert isinstance(robot.failure(), NoAnswerError)
    assert f"no node of {MODEL} answers in ROS 2, domain" in str(robot.failure())


async def test_a_link_that_breaks_ends_it_with_the_reason(robot: Robot) -> None:
    robot.start_nodes()
    await robot.begin()
    await robot.clock.advance(1.0)
    robot.graph.fail()
    await settle()

    assert isinstance(robot.failure(), NoAnswerError)
    assert str(robot.failure()) == "the graph failed"


async def test_types_that_are_not_installed_are_named() -> None:
    robot = Robot("lifecycle_msgs/srv/GetState")
    await robot.begin()
    await settle()

    assert isinstance(robot.failure(), NoAnswerError)
    assert "lifecycle_msgs" in str(robot.failure())


async def test_warnings_of_the_log_are_notes_and_only_the_newest_wait(robot: Robot) -> None:
    await robot.begin()
    for number in range(100):
        robot.warnings.handle(logging.makeLogRecord({"msg": f"odd {number}", "levelno": 30}))
    await robot.clock.advance(1.0)

    notes = robot.feed.watch.robot.notes
    assert [note.words for note in notes] == [f"odd {number}" for number in range(80, 100)]


# --- the command ---------------------------------------------------------------------------------


def test_a_model_that_cannot_be_read_is_told(tmp_path: Path) -> None:
    with pytest.raises(NoAnswerError, match="cannot be read"):
        ros_monitor(str(tmp_path / "gone.yaml"), "text", once=True)


def test_an_invalid_model_is_told_with_its_places(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text("arm:\n  ros__parameters:\n    type: node\n    modes: 3\n")

    assert ros_monitor(str(path), "text", once=True) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith(f"{path}:")


def test_without_ros_it_is_said_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    def join() -> None:
        raise MisuseError("ROS 2 is not available")

    monkeypatch.setattr(module, "join_graph", join)

    with pytest.raises(NoAnswerError, match="ROS 2 is not available"):
        ros_monitor(EXAMPLE, "text", once=True)


@pytest.mark.parametrize(
    ("is_drawn", "once", "form", "kept"),
    [
        (True, False, "text", True),
        (True, True, "text", False),
        (True, False, "json", False),
        (False, False, "text", False),
    ],
)
def test_only_where_it_draws_are_warnings_kept_from_the_terminal(
    is_drawn: bool, once: bool, form: str, kept: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: list[tuple[str, bool]] = []
    handlers: list[logging.Handler] = []

    def show(make: MakeFeed, form: str, *, once: bool) -> None:
        make(lambda: None)
        shown.append((form, once))
        handlers.extend(h for h in logging.getLogger().handlers if isinstance(h, Warnings))

    monkeypatch.setattr(module, "join_graph", lambda: FakeGraph(ManualClock()))
    monkeypatch.setattr(module, "is_drawn", lambda: is_drawn)
    monkeypatch.setattr(module, "show", show)

    assert ros_monitor(EXAMPLE, form, once=once) == 0  # type: ignore[arg-type]
    assert shown == [(form, once)]
    assert len(handlers) == kept
    assert not any(isinstance(h, Warnings) for h in logging.getLogger().handlers)
