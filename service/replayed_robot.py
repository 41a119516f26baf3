"""A recorded robot that can be looked at: what was recorded goes through the live code again.

Nothing but what was recorded changes it: its supervisor rejects everything else, and its commands
go nowhere.
"""

import asyncio
from typing import NoReturn

from domain.commands import Drive, NodeCommand
from domain.errors import PilothouseError
from domain.inputs import Input, Restored
from domain.onboard import Onboard
from domain.outbox import Outputs
from domain.timebase import Instant
from service.event_log import EventLog
from service.files.model_file import LoadedModel
from service.ports import Deliver
from service.recorded_pieces import Piece
from service.replay import Difference, core_of_piece, show_step
from service.storage.journal import Step
from service.supervisor import Supervisor
from service.virtual_clock import VirtualClock


class RecordingError(PilothouseError):
    """A request to a robot that is only a recording."""

    code = "RECORDING"

    def __init__(self) -> None:
        super().__init__("this is a recording: it can be looked at, and nothing in it changes")


class ReplayDiffersError(PilothouseError):
    """A record from which something else follows than what followed then."""

    code = "REPLAY_DIFFERS"

    def __init__(self, difference: Difference) -> None:
        super().__init__(f"the record does not lead to what was seen then: {difference.words}")
        self.hint = "`pilothouse export` makes a folder of it that can go with a bug report"


class ReplayedRobot:
    """The robot of one piece of a record, at the time that `advance_to` was given last."""

    def __init__(self, piece: Piece, version: str, simulated: tuple[str, ...] = ()) -> None:
        """Make the core again as it was before the first step.

        Args:
            piece: Of a record; its steps are read as time goes on.
            version: This release of Pilothouse.
            simulated: The simulated pieces of the robot, which no record tells.

        Raises:
            PilothouseError: The core cannot be made again.
        """
        self._onboard = core_of_piece(piece, version)
        self._steps = piece.steps
        self._number = piece.first
        self._next = next(self._steps, None)
        first = self._onboard.core.next_event
        if self._next is not None and isinstance(self._next.given, Restored):
            first = self._next.given.next_event
        boot = piece.boot
        self.clock = VirtualClock(boot.started_at, boot.wall_at)
        self.supervisor = Supervisor(
            LoadedModel(self._onboard.core.model, (), boot.model),
            _Untouchable(self._onboard.core, self._onboard.navigation),
            self.clock,
            _Nowhere(),
            simulated=simulated,
            events=EventLog(epoch=boot.epoch, before=first - 1),
        )
        # Nothing that a client could wait for comes.
        self.supervisor.change_ends.stop()

    @property
    def next_at(self) -> Instant | None:
        """Return when the next recorded step is; None: there is none."""
        return None if self._next is None else self._next.at

    def advance_to(self, end: Instant) -> None:
        """Take what was recorded up to and including `end`; time never goes back.

        Raises:
            PilothouseError: The record is broken, or something else follows than what followed.
        """
        while self._next is not None and self._next.at <= end:
            step = self._next
            self.clock.set(step.at)
            shown = show_step(self._onboard, step, self._number)
            if isinstance(shown, Difference):
                raise ReplayDiffersError(shown)
            self.supervisor.carry_out(Step(step.at, step.given, step.is_late, shown))
            self._next = next(self._steps, None)
            self._number += 1
        self.clock.set(end)

    def publish(self) -> None:
        """Publish a frame, as each tick of a live service does."""
        publisher = self.supervisor.publisher
        publisher.last_tick_at = self.clock.now()
        publisher.publish()


class _Untouchable(Onboard):
    """A core that shows its views; it takes no input, and has no deadlines of its own."""

    def wake_at(self) -> None:
        """Return None: what was due is in the record."""

    def handle(self, given: Input, now: Instant) -> Outputs:
        """Reject an input.

        Raises:
            RecordingError: Always.
        """
        raise RecordingError

    take_in = handle


class _Nowhere:
    """A backend without a robot."""

    def send(self, command: NodeCommand | Drive, /) -> None:
        """Do nothing: it was sent when it was recorded."""

    async def run(self, deliver: Deliver) -> NoReturn:
        """Deliver nothing, until cancelled."""
        while True:
            await asyncio.get_running_loop().create_future()
