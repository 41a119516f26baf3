"""Plays a recording: takes what was recorded as time goes on, and publishes 20 frames a second."""

import asyncio
import logging
from collections.abc import Callable, Iterator

from api.replaying.recording import Recording
from domain.errors import PilothouseError
from domain.timebase import Duration, Instant, seconds
from service.clock import Clock
from service.frame_publisher import PERIOD
from service.recorded_pieces import NothingRecordedError, Piece, offset_of
from service.replayed_robot import ReplayedRobot
from service.storage.errors import UnusableFolderError
from service.storage.sqlite.connection import FAILURES, words

log = logging.getLogger(__name__)

MIN_SPEED, MAX_SPEED = 0.1, 100.0
_FAILURES = (PilothouseError, UnusableFolderError, *FAILURES)
"""What a record may come to while it is read: broken, dropped by its service, unreadable."""
_PORTION: Duration = seconds(0.5)
"""Time of the record that is taken in before other tasks run: some 30 steps, 3 ms."""
_MOST_OWED: Duration = seconds(0.5)
"""Where the machine cannot keep up with the speed, the rest is let go."""


class Player:
    """The robot of a recording at one moment after the other."""

    def __init__(
        self,
        recording: Recording,
        version: str,
        clock: Clock,
        speed: float = 1.0,
    ) -> None:
        """Open the recording at its begin.

        Args:
            recording: What is played.
            version: This release of Pilothouse.
            clock: Of the viewer.
            speed: How much faster than then.

        Raises:
            PilothouseError: It cannot be replayed.
        """
        self.recording = recording
        self.speed = speed
        self.is_paused = False
        self.fault: str | None = None
        """Why it cannot go on; None: it can."""
        self.on_robot: Callable[[ReplayedRobot], None] = lambda _: None
        """Called with each robot that is shown from then on: of another run, or of earlier."""
        self._version = version
        self._clock = clock
        self._wanted: list[tuple[Instant, asyncio.Future[None]]] = []
        self._pieces: Iterator[Piece] = iter(())
        self.wall = recording.begin
        """Time of day that is shown, ns since 1970 UTC."""
        self.robot, self._offset = self._opened(recording.begin)

    async def run(self) -> None:
        """Play until cancelled; at its end it stands."""
        due = last = self._clock.now()
        while True:
            while self._wanted:
                await self._go_back(*self._wanted.pop(0))
            now = self._clock.now()
            if not self.is_paused and self.fault is None:
                passed = round((now - last) * self.speed)
                wanted = self.wall + min(passed, round((PERIOD + _MOST_OWED) * self.speed))
                await self._play_to(min(wanted, self.recording.end))
            last = now
            self.robot.publish()
            due = max(due + PERIOD, self._clock.now() - _MOST_OWED)
            await self._clock.sleep_until(due)

    async def seek(self, wall: Instant) -> None:
        """Show another moment; return when it is shown.

        Args:
            wall: Time of day, ns since 1970 UTC; the nearest one that there is.
        """
        done = asyncio.get_running_loop().create_future()
        begin, end = self.recording.begin, self.recording.end
        self._wanted.append((min(max(wall, begin), end), done))
        await done

    async def _go_back(self, wall: Instant, done: "asyncio.Future[None]") -> None:
        """Open the recording anew and play to a moment without showing what is before."""
        self.fault = None
        try:
            self.robot, self._offset = self._opened(wall)
            await self._play_to(wall)
        except _FAILURES as error:
            self._stop_at(error)
        self.on_robot(self.robot)
        if not done.done():
            done.set_result(None)

    async def _play_to(self, wall: Instant) -> None:
        """Take what was recorded up to a time of day, a little at a time."""
        try:
            while self.fault is None:
                robot = self.robot
                due = robot.next_at
                if due is None:
                    if not self._goes_on():
                        break
                    wall = max(wall, self.wall)
                elif due + self._offset > wall:
                    break
                else:
                    robot.advance_to(min(wall - self._offset, due + _PORTION))
                    await asyncio.sleep(0)
            self.robot.advance_to(wall - self._offset)
            self.wall = wall
        except _FAILURES as error:
            self._stop_at(error)

    def _goes_on(self) -> bool:
        """Go on with the next piece; return whether there is one.

        In between the service did not run, or what it did was lost: that takes no time.
        """
        piece = next(self._pieces, None)
        if piece is None:
            return False
        robot, offset = self._made(piece)
        begin = (robot.next_at or piece.boot.started_at) + offset
        if begin >= self.recording.end:
            self._pieces = iter(())
            return False
        self.robot, self._offset = robot, offset
        self.wall = max(self.wall, begin)
        self.on_robot(robot)
        return True

    def _opened(self, wall: Instant) -> tuple[ReplayedRobot, Duration]:
        self._pieces = self.recording.pieces_from(wall)
        piece = next(self._pieces, None)
        if piece is None:
            raise NothingRecordedError("there is nothing after that moment")
        return self._made(piece)

    def _made(self, piece: Piece) -> tuple[ReplayedRobot, Duration]:
        return ReplayedRobot(piece, self._version), offset_of(piece.boot)

    def _stop_at(self, error: Exception) -> None:
        self.fault = error.message if isinstance(error, PilothouseError) else words(error)
        log.error("the replay stops: %s", self.fault)
        self.wall = self.robot.clock.now() + self._offset
