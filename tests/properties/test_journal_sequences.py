"""Whatever a robot does between starts, kills and ends: what is kept is what it kept last."""

import asyncio
import os
import shutil
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from service.codec.codec import STEPS
from service.storage.journal import EventQuery
from service.storage.sqlite.folder import Retention
from service.storage.sqlite.places import Places
from service.storage.sqlite.recorded_log import RecordedLog
from tests.support.folder_robot import ENOUGH_S, as_a_kill_leaves, holds, started
from tests.support.noted_robot import NotedRobot

SOAK = os.environ.get("PILOTHOUSE_SOAK") == "1"
OWNERS = ("ada", "bob", "planner")
IN_MEMORY = Path("/dev/shm")
MANY_FILES = Retention(file_bytes=60_000)

acts = st.one_of(
    st.tuples(st.just("holds"), st.sampled_from(OWNERS), st.sampled_from(("lunch", "rain"))),
    st.tuples(st.just("releases"), st.sampled_from(OWNERS)),
    st.tuples(st.just("changes")),
    st.tuples(st.just("reads")),
    st.tuples(st.just("keeps"), st.integers(0, 3)),
    st.tuples(st.just("commits")),
    st.tuples(st.just("ends")),
    st.tuples(st.just("is killed")),
    st.tuples(st.just("loses its state")),
)


@dataclass
class Expected:
    """What must be found."""

    holds: dict[str, str] = field(default_factory=dict)
    own: int | None = None
    events: list[int] = field(default_factory=list)


class Story:
    """Lives the acts on a folder, beside what must come of them."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.runs = 0
        self.expected = Expected()
        self.robot: NotedRobot

    async def start(self) -> None:
        self.runs += 1
        self.robot = await started(self.folder, self.runs, MANY_FILES)
        found = self.robot.journal.found
        assert found.restored.stop_because == ""
        assert holds(found) == self.expected.holds
        assert (found.own or {}).get("page") == self.expected.own
        assert found.restored.boot == self.runs
        assert found.restored.next_event > max(self.expected.events, default=0)

    async def act(self, what: str, *how: object) -> None:
        robot, expected, first = self.robot, self.expected, self.robot.next_event
        match what, how:
            case "holds", (str(owner), str(reason)):
                robot.holds(owner, reason)
                expected.holds[owner] = reason
            case "releases", (str(owner),):
                robot.releases(owner)
                expected.holds.pop(owner, None)
            case "changes", _:
                robot.changes("arm", "FAST")
            case "reads", _:
                robot.reads()
            case "keeps", (int(value),):
                robot.journal.keep("page", value)
                expected.own = value
            case "commits", _:
                assert await robot.journal.commit(ENOUGH_S)
            case _:
                await self._restart(what)
        expected.events += range(first, robot.next_event)

    async def _restart(self, how: str) -> None:
        if how == "is killed":
            # Only what was answered is certain.
            assert await self.robot.journal.commit(ENOUGH_S)
            left = as_a_kill_leaves(self.folder)
            await self.robot.journal.close()
            shutil.rmtree(self.folder)
            left.rename(self.folder)
        else:
            await self.robot.journal.close()
        if how == "loses its state":
            Places(self.folder).state.unlink()
        await self.start()

    async def end(self) -> None:
        assert await self.robot.journal.commit(ENOUGH_S)
        found = await self.robot.journal.events(EventQuery(after=0, limit=10_000))
        await self.robot.journal.close()
        assert [event.id for event in found] == self.expected.events
        log = RecordedLog(self.folder)
        steps = [STEPS.decode(line) for run in log.runs() for _, line in log.lines(run.number)]
        in_steps = [event.id for step in steps for event in step.events]
        assert in_steps == self.expected.events


async def live(folder: Path, story: list[tuple[object, ...]]) -> None:
    told = Story(folder)
    await told.start()
    for what, *how in story:
        await told.act(str(what), *how)
    await told.end()


@settings(max_examples=1_000 if SOAK else 25)
@given(st.lists(acts, max_size=30))
def test_what_is_kept_is_what_was_kept_last(story: list[tuple[object, ...]]) -> None:
    with tempfile.TemporaryDirectory(dir=IN_MEMORY if IN_MEMORY.is_dir() else None) as base:
        asyncio.run(live(Path(base) / "robot", story))
