"""The shell round the core: hands it what happens, carries out what it says, publishes at 20 Hz.

It decides nothing. Whatever arrives is handed to the core at once, and when something becomes due
there, it is told so at that time; the tick only publishes.
"""

import asyncio
import logging
from collections import Counter
from collections.abc import Callable, Coroutine, Sequence
from contextlib import suppress

from domain.commands import PreemptGoal, SendGoal
from domain.errors import PilothouseError
from domain.events.changes import ChangeEnded
from domain.findings import Finding
from domain.health.signals import ESTOP_SIGNAL
from domain.identifiers import ChangeId
from domain.inputs import HoldRequest, Input, Reading, Readings, SignalValue, TimePassed
from domain.onboard import Onboard
from domain.outbox import Outputs
from domain.parts.system_model import SmhModel
from domain.paths.speed_profile import SpeedLimits
from domain.simulation.robot import SimulatedRobot
from domain.snapshot import ChangeStatus, ChangeView
from domain.state_and_mode import PartName
from domain.supervision import Supervision
from domain.timebase import Instant, seconds, to_seconds
from service.clock import Clock
from service.event_log import EventLog
from service.files.model_file import LoadedModel
from service.frame_feed import Frame, FrameFeed
from service.pacing import Alarm
from service.ports import RobotBackend
from service.simulation.mock_source import MockSource
from service.unasked import log_unasked

log = logging.getLogger(__name__)

PERIOD = seconds(0.05)
_UNNAMED = "api"
"""Source of readings whose sender does not say who measured."""
_TICKS_PER_FULL = 20
"""One complete frame a second, so that a client that lost something is soon right again."""


class TaskFailedError(Exception):
    """A task that should run for as long as the service does has ended."""

    def __init__(self, name: str) -> None:
        super().__init__(f"the task {name!r} has ended")
        self.name = name


class Supervisor:
    """Owns the core and every task that feeds it; `run` ends only cancelled or broken."""

    def __init__(
        self,
        loaded: LoadedModel,
        onboard: Onboard,
        clock: Clock,
        backend: RobotBackend,
        mock: MockSource | None = None,
        simulated: Sequence[str] = (),
        events: EventLog | None = None,
    ) -> None:
        self.core: Supervision = onboard.core
        """For looking; what happens goes through `submit`."""
        self.clock = clock
        self.started_at = clock.now()
        """When this run of the service began, and with it its epoch."""
        self.mock = mock
        self.simulated = tuple(simulated)
        self.frames = FrameFeed()
        self.events = events or EventLog()
        self.late_ticks = 0
        self.last_tick_at: Instant | None = None
        self.on_tick: list[Callable[[float], None]] = []
        """Called with the seconds since the tick before; must return at once."""
        self.ended_changes: Counter[str] = Counter()
        """Changes that ended so far, by how they ended."""
        self._loaded = loaded
        self._onboard = onboard
        self._backend = backend
        self._seq = 0
        self._ticks = 0
        self._changed_parts: set[PartName] = set()
        self._changed_signals: set[str] = set()
        self._task_changed = False
        self._vehicle_changed = False
        self._alarm = Alarm(onboard.wake_at, self.let_pass, clock)
        self._ending = False
        self._waiting: dict[ChangeId, set[asyncio.Future[None]]] = {}

    @property
    def model(self) -> SmhModel:
        """Return the model of the robot."""
        return self._loaded.model

    @property
    def model_text(self) -> str:
        """Return the model file as it was read."""
        return self._loaded.text

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Return what is odd about the model."""
        return self._loaded.warnings

    @property
    def simulated_parts(self) -> tuple[Onboard, SimulatedRobot] | None:
        """Return what a simulation can go on with a copy of; None: the robot is real."""
        robot = self._backend.simulation
        return None if robot is None else (self._onboard, robot)

    @property
    def speed_limits(self) -> SpeedLimits:
        """Return how hard the vehicle may be accelerated."""
        return self._onboard.navigation.settings.speed

    @property
    def epoch(self) -> str:
        """Return the name of this run of the service; event ids count from 1 in each."""
        return self.events.epoch

    @property
    def snapshot_seq(self) -> int:
        """Return the number of the newest frame."""
        return self._seq

    async def run(self) -> None:
        """Run until cancelled; the first task that ends, ends them all.

        Raises:
            ExceptionGroup: Of a `TaskFailedError` that names the task and has what it raised as its
                cause.
        """
        async with asyncio.TaskGroup() as tasks:
            work: dict[str, Coroutine[object, object, None]] = {
                "robot": self._backend.run(self.deliver),
                "deadlines": self._alarm.run(),
                "log": log_unasked(self.events),
                "tick": self._tick_forever(),
            }
            for name, coroutine in work.items():
                tasks.create_task(_forever(name, coroutine), name=name)

    # --- inputs ----------------------------------------------------------------------------------

    def submit(self, given: Input) -> Outputs:
        """Hand an input to the core and carry out what follows.

        Raises:
            PilothouseError: It is refused; nothing was changed by it.
        """
        now = self.clock.now()
        try:
            outputs = self._onboard.handle(given, now)
        except PilothouseError:
            self._carry_out(self._onboard.handle(TimePassed(), now))
            raise
        finally:
            self._alarm.check()
        self._carry_out(outputs)
        return outputs

    def submit_readings(
        self, items: Sequence[Reading], source: str | None = None, actor: str = ""
    ) -> Outputs:
        """Hand in readings from outside; where the mock runs, it goes on with their values.

        Args:
            items: All are taken, or none is.
            source: Who measured; None: a sender without a name, for whom the mock stands where it
                runs. A named source of `estop` is kept apart from the mock's own.
            actor: Who sent them.

        Raises:
            PilothouseError: One of them is refused; none was taken.
        """
        mock = self.mock
        if mock is None:
            return self.submit(Readings(tuple(items), source or _UNNAMED, actor))
        for readings in mock.due():
            self.submit(readings)
        # Any of them: an e-stop that came together with a signal of another kind has to be released
        # by the next reading without a name too.
        stands_in = source is None and any(mock.holds(item.signal) for item in items)
        own = mock.source if stands_in else source or _UNNAMED
        outputs = self.submit(Readings(tuple(items), own, actor))
        for item in items:
            if mock.holds(item.signal) and (stands_in or item.signal != ESTOP_SIGNAL):
                mock.hold(item.signal, item.value)
        return outputs

    def hold_mock(self, signal: str, value: SignalValue, actor: str = "") -> Outputs:
        """Let the mock hold another value, from now on.

        Raises:
            PilothouseError: The value is refused; the mock goes on with the one before.
        """
        return self.submit_readings([Reading(signal, value)], actor=actor)

    async def change_ended(self, change: ChangeId, timeout_s: float) -> ChangeView:
        """Return a change once it has ended, or as it is after `timeout_s` seconds.

        Raises:
            UnknownChangeError: There is no such change.
        """
        view = self.core.change(change)
        if view.status is not ChangeStatus.RUNNING or timeout_s <= 0 or self._ending:
            return view
        ended: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        waiting = self._waiting.setdefault(change, set())
        waiting.add(ended)
        deadline = self.clock.now() + seconds(timeout_s)
        timer = asyncio.ensure_future(self.clock.sleep_until(deadline))
        try:
            await asyncio.wait({ended, timer}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            waiting.discard(ended)
            timer.cancel()
            with suppress(asyncio.CancelledError):
                await timer
        return self.core.change(change)

    def stop_driving(self) -> None:
        """Hold the task and let the vehicle stand still, since the service ends."""
        # Refused only where there is no room for one more hold, and so it stands already.
        with suppress(PilothouseError):
            self.submit(HoldRequest("service", "the service ends", "service"))

    def stop_waiting(self) -> None:
        """Let everybody who waits for a change go, since the service ends."""
        self._ending = True
        for change in list(self._waiting):
            self._wake_waiting(change)

    def let_pass(self) -> None:
        """Let happen what time alone has made due."""
        due = self._onboard.wake_at()
        if due is not None and due <= self.clock.now():
            self.submit(TimePassed())

    def deliver(self, given: Input) -> None:
        """Take what an adapter reports; one bad report must not end the adapter."""
        try:
            self.submit(given)
        except PilothouseError as error:
            log.warning("refused %s: %s", type(given).__name__, error)

    # --- outputs ---------------------------------------------------------------------------------

    def _carry_out(self, outputs: Outputs) -> None:
        """Act on the robot first, then tell."""
        for command in outputs.commands:
            # Goals stay on board; what is left is for nodes and the vehicle.
            if not isinstance(command, SendGoal | PreemptGoal):
                self._backend.send(command)
        self._changed_parts |= outputs.parts
        self._changed_signals |= outputs.signals
        self._task_changed |= outputs.task_changed
        self._vehicle_changed |= outputs.vehicle_changed
        for event in outputs.events:
            self.events.append(event)
            if isinstance(event.event, ChangeEnded):
                self.ended_changes[event.event.status] += 1
                self._wake_waiting(event.event.change)
        if outputs.system_state and self._seq:
            self._publish()

    def _wake_waiting(self, change: ChangeId) -> None:
        for ended in self._waiting.pop(change, ()):
            if not ended.done():
                ended.set_result(None)

    def _publish(self, *, full: bool = False) -> None:
        """Publish one frame: everything, or what changed since the last one."""
        full = full or self.frames.wants_full
        self._seq += 1
        core = self.core
        holds, emergency_stop = core.driving.holds, core.emergency_stop()
        last = self.frames.newest
        frame = Frame(
            seq=self._seq,
            at=self.clock.now(),
            system_state=core.system_state(),
            parts=core.parts() if full else {p: core.part(p) for p in sorted(self._changed_parts)},
            signals=(
                core.signals()
                if full
                else {s: core.signal(s) for s in sorted(self._changed_signals)}
            ),
            task=core.driving.latest_task if last is None or self._task_changed else last.task,
            task_changed=full or self._task_changed,
            vehicle=core.driving.vehicle,
            vehicle_changed=full or self._vehicle_changed,
            # Both are the same objects as long as nothing about them changes.
            holds=holds,
            holds_changed=full or last is None or holds is not last.holds,
            emergency_stop=emergency_stop,
            emergency_stop_changed=(
                full or last is None or emergency_stop is not last.emergency_stop
            ),
            full=full,
            simulated=self.simulated,
        )
        self._changed_parts.clear()
        self._changed_signals.clear()
        self._task_changed = self._vehicle_changed = False
        self.frames.publish(frame)

    async def _tick_forever(self) -> None:
        """Tick on a fixed grid; a late tick is skipped and counted, never made up for."""
        start = self.clock.now()
        count = 0
        while True:
            self._tick()
            count += 1
            late = self.clock.now() - (start + count * PERIOD)
            if late >= PERIOD:
                skipped = late // PERIOD + 1
                count += skipped
                self.late_ticks += skipped
                log.warning("%d ticks were skipped: %.0f ms late", skipped, late / 1e6)
            await self.clock.sleep_until(start + count * PERIOD)

    def _tick(self) -> None:
        now = self.clock.now()
        if self.last_tick_at is not None:
            for observe in self.on_tick:
                observe(to_seconds(now - self.last_tick_at))
        self.last_tick_at = now
        self._publish(full=self._ticks % _TICKS_PER_FULL == 0)
        self._ticks += 1


async def _forever(name: str, work: Coroutine[object, object, None]) -> None:
    """Await what should never end, and name it when it does."""
    try:
        await work
    except Exception as error:
        raise TaskFailedError(name) from error
    raise TaskFailedError(name)
