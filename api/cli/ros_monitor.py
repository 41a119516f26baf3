"""`pilothouse monitor --ros2`: watch a robot in a ROS 2 graph, without a service."""

import json
import logging
import os
import sys
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from functools import partial

from api.cli.checked_file import as_text
from api.cli.first_ended import until_first_ends
from api.cli.monitor.monitor import is_drawn, show
from api.cli.monitor.output import Form
from api.cli.monitor.watch import Watch
from api.cli.robot_files import read_robot_files
from api.client.outcomes import NoAnswerError, Outcome
from api.http.part_text import part_text
from api.http.schemas.base import timestamp
from api.serving.joining import join_graph
from api.serving.misuse import MisuseError
from domain.parts.system_model import SmhModel
from domain.timebase import Duration, Instant, seconds
from service.clock import Clock, MonotonicClock
from service.files.text_file import UnreadableFileError
from service.ros.backend.observer import RosObserver
from service.ros.graph.graph import GraphFailedError, RosGraph, UnknownTypeError

_FRAME: Duration = seconds(0.05)
_ALIVE: Duration = seconds(0.5)
"""At the latest after this time a frame tells that all is as before."""
_STILL: Duration = seconds(1.0)
"""Once all nodes were heard, and nothing new for this long, all that was latched was heard too."""
_UNTIL_TARGETS: Duration = seconds(3.0)
"""Nobody announces targets if none was heard for this long: on a busy machine the ends of a topic
find each other later than 1 s after the nodes have answered."""
_PATIENCE: Duration = seconds(5.0)
"""After this time, a node that was not heard is absent."""
_NOTES_KEPT = 20


def ros_monitor(path: str, form: Form, *, once: bool) -> int:
    """Show a robot in the ROS 2 graph until q or Ctrl-C, or once; return the exit code.

    Args:
        path: Of the model file.
        form: `text` for people, `json` for programs.
        once: Write one picture only.

    Raises:
        NoAnswerError: The model cannot be read, there is no ROS 2, the link to it broke, or with
            `once` no node answers.
    """
    try:
        read = read_robot_files(path, None)
        if read.model is None:
            for line in as_text(read.files):
                print(line, file=sys.stderr)
            return Outcome.UNKNOWN
        graph = join_graph()
    except (UnreadableFileError, MisuseError) as error:
        raise NoAnswerError(str(error)) from error
    warnings = Warnings()
    make = partial(GraphFeed, path, read.model, graph, MonotonicClock(), warnings)
    keeps = form == "text" and not once and is_drawn()
    with warnings.kept() if keeps else nullcontext():
        show(make, form, once=once)
    return Outcome.SUCCEEDED


class Warnings(logging.Handler):
    """Keeps the newest warnings of the log, from any thread."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._words: deque[str] = deque(maxlen=_NOTES_KEPT)

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Keep what is logged from the terminal, whose drawn screen it would spoil."""
        logging.getLogger().addHandler(self)
        try:
            yield
        finally:
            logging.getLogger().removeHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a warning."""
        self._words.append(record.getMessage())

    def take(self) -> list[str]:
        """Return the warnings since the last call."""
        taken = []
        while self._words:
            taken.append(self._words.popleft())
        return taken


class GraphFeed:
    """Tells a watch what is observed in a ROS 2 graph, in frames such as a service sends."""

    def __init__(
        self,
        path: str,
        model: SmhModel,
        graph: RosGraph,
        clock: Clock,
        warnings: Warnings,
        news: Callable[[], None],
    ) -> None:
        """Prepare; nothing is observed yet.

        Args:
            path: Of the model file, as it is shown.
            model: The model.
            graph: The ROS 2 graph, which is left at the end.
            clock: Of this machine.
            warnings: Shown as notes.
            news: Called after each frame.
        """
        domain = os.environ.get("ROS_DOMAIN_ID") or "0"
        self.watch = Watch(f"ROS 2, domain {domain}", news)
        self._path = path
        self._observer = RosObserver(model, graph, clock)
        self._clock = clock
        self._warnings = warnings
        self._notes = 0
        self._began_at = self._changed_at = clock.now()
        self._told_at: Instant | None = None
        self._is_settled = False

    async def run(self) -> None:
        """Observe and tell until cancelled.

        Raises:
            NoAnswerError: The link to ROS 2 broke, or its message types are not installed.
        """
        await until_first_ends(self._observe(), self._tell_forever())

    async def run_once(self) -> None:
        """Observe until everything is known that can be known soon.

        Raises:
            NoAnswerError: As `run`, or no node answers.
        """
        await until_first_ends(self._observe(), self._tell_until_settled())
        nodes = self._observer.parts.model.nodes
        if nodes and not any(self._observer.parts.view(node).reachable for node in nodes):
            raise NoAnswerError(
                f"no node of {self._path} answers in {self.watch.view().url}: are the nodes"
                " running, is this the ROS_DOMAIN_ID of the robot, and the model that it runs?"
            )

    async def _observe(self) -> None:
        try:
            await self._observer.run(self._note_change)
        except* (UnknownTypeError, GraphFailedError) as errors:
            raise NoAnswerError(str(errors.exceptions[0])) from errors

    def _note_change(self) -> None:
        self._changed_at = self._clock.now()

    async def _tell_forever(self) -> None:
        while True:
            self._tell()
            await self._clock.sleep_until(self._clock.now() + _FRAME)

    async def _tell_until_settled(self) -> None:
        while not self._is_settled:
            self._tell()
            await self._clock.sleep_until(self._clock.now() + _FRAME)

    def _tell(self) -> None:
        """Tell what is new, or now and then that nothing is."""
        now, parts = self._clock.now(), self._observer.parts
        is_news = self._settle(now)
        changed = parts.take_changed()
        if not (changed or is_news) and self._told_at and now - self._told_at < _ALIVE:
            return
        at = timestamp(self._clock, now)
        for words in self._warnings.take():
            self._notes += 1
            self.watch.take(
                {"type": "event", "id": self._notes, "at": at, "notable": True, "words": words}
            )
        names = parts.model.parts if self._told_at is None else changed
        self._told_at = now
        show_time = partial(timestamp, self._clock)
        self.watch.take(
            {
                "type": "graph",
                "at": at,
                "model": self._path,
                "settled": self._is_settled,
                "parts": {
                    name: json.loads(part_text(parts.view(name), show_time)) for name in names
                },
            }
        )

    def _settle(self, now: Instant) -> bool:
        """Judge whether all that can be known soon is known; return whether it is since now."""
        if self._is_settled:
            return False
        parts = self._observer.parts
        is_still = now - self._changed_at >= _STILL
        waited = now - self._began_at
        all_heard = is_still and all(parts.view(node).reachable for node in parts.model.nodes)
        heard_targets = parts.has_targets or waited >= _UNTIL_TARGETS
        self._is_settled = (all_heard and heard_targets) or waited >= _PATIENCE
        return self._is_settled
