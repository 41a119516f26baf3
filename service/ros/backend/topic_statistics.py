"""Signals that tell how a ROS topic arrives: its rate, its longest gap, the age of its messages.

Of a message nothing but the stamp is read, so that a topic of images costs little more than their
transport.
"""

from collections import deque
from collections.abc import Callable
from itertools import chain

from domain.inputs import Reading, Readings
from domain.timebase import Instant, seconds, to_seconds
from domain.windows.settings import Statistic, WindowSettings
from domain.windows.window import Window
from service.clock import Clock, to_datetime
from service.files.robot_file import RobotSettings
from service.files.ros2_block import StatisticBlock
from service.ros.graph.graph import Lane, RosGraph

NODE = "pilothouse_statistics"

PERIOD_S = 0.2
"""Time between two readings of each statistic."""

MAX_ARRIVALS = 10_000
"""Arrivals of a topic that wait for the next reading; of more, the oldest are left out."""

_USUAL_WINDOW_S = 5.0


class TopicStatistics:
    """Delivers each statistic of the robot file five times a second, also while a topic is silent.

    A rate and a gap are known once their window has passed once since the start; an age once a
    message with a stamp has come.
    """

    def __init__(self, robot: RobotSettings, graph: RosGraph, clock: Clock) -> None:
        self._topics: dict[str, _Topic] = {}
        for name, block in robot.ros2.statistics.items():
            topic = self._topics.setdefault(block.topic, _Topic(block.type, clock))
            topic.add(name, block)
        self._graph = graph
        self._clock = clock

    def start(self) -> None:
        """Listen while the graph is open.

        Raises:
            UnknownTypeError: The type of a topic is not installed.
        """
        if not self._topics:
            return
        node = self._graph.node(NODE, Lane.SENSORS)
        for name, topic in self._topics.items():
            node.watch_arrivals(name, topic.type, topic.hear)

    async def run(self, deliver: Callable[[Readings], None]) -> None:
        """Deliver readings until cancelled; return at once if there is nothing to measure.

        Args:
            deliver: Takes them, and returns at once.
        """
        while self._topics:
            await self._clock.sleep_until(self._clock.now() + seconds(PERIOD_S))
            self._tell(deliver)

    def _tell(self, deliver: Callable[[Readings], None]) -> None:
        for name, topic in self._topics.items():
            items = tuple(Reading(signal, value) for signal, value in topic.take())
            if items:
                deliver(Readings(items, source=f"ros:{name}"))


class _Topic:
    """The arrivals on one topic: heard on the thread of ROS, counted on that of the event loop."""

    def __init__(self, type_name: str, clock: Clock) -> None:
        self.type = type_name
        self._clock = clock
        self._start = clock.now()
        self._heard: deque[tuple[Instant, int | None]] = deque(maxlen=MAX_ARRIVALS)
        self._windows: dict[str, Window] = {}
        self._aged: list[str] = []
        """Signals that have the age."""
        self._stamp_ns: int | None = None
        """Of the newest message."""

    def add(self, signal: str, block: StatisticBlock) -> None:
        """Measure a statistic from now on."""
        if block.statistic == "age":
            self._aged.append(signal)
            return
        length = seconds(_USUAL_WINDOW_S if block.window_s is None else block.window_s)
        settings = WindowSettings(statistic=Statistic(block.statistic), length=length)
        self._windows[signal] = Window(settings, self._start)

    def hear(self, stamp_ns: int | None) -> None:
        """Note that a message arrived; on the thread of ROS."""
        self._heard.append((self._clock.now(), stamp_ns))

    def take(self) -> list[tuple[str, float]]:
        """Return the value of each statistic that is known."""
        for _ in range(len(self._heard)):
            at, self._stamp_ns = self._heard.popleft()
            for window in self._windows.values():
                window.add(at, 0.0)
        # Not earlier, since a window may not go back before what it has heard.
        now = self._clock.now()
        values = ((signal, window.value(now)) for signal, window in self._windows.items())
        ages = ((signal, self._age_s(now)) for signal in self._aged)
        return [(signal, value) for signal, value in chain(values, ages) if value is not None]

    def _age_s(self, now: Instant) -> float | None:
        """Return the age of the newest message; None: none has a stamp. Ahead of us it is 0."""
        if self._stamp_ns is None:
            return None
        return to_seconds(max(0, now - self._clock.from_wall(to_datetime(self._stamp_ns))))
