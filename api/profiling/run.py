"""One run: a robot that drives is stopped by an error and started again; the times are noted."""

from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from random import Random
from typing import TypeAlias

from api.profiling.robot import Robot, Seen
from api.profiling.run_file import Run
from api.profiling.triggers import GOOD, Trigger
from domain.health.signals import CountsFrom

SPEED_MPS = 2.8
"""Cruise speed of the task, as in smart_polaris."""
PATIENCE_S = 2.0
"""A phase that is not seen this long after it was due has failed."""

_PERIOD_S = 0.1
"""Between two readings of a signal."""
_UP_TO_SPEED_MPS = 0.3
"""The drive command from which on the robot drives."""
_START_PATIENCE_S = 10.0
_SETTLING_S = 0.2
_PHASE_S = 0.1
"""Pauses get up to this much longer at random, so that the ticks of the service (20 Hz) are met at
every phase."""
_MARGIN_S = 30.0
"""How much longer the path is than the persistence takes."""

Awaited: TypeAlias = Mapping[str, Callable[[Seen], bool]]
"""What has to be seen, by the name of its time."""

_STARTED: Awaited = {
    "running_s": lambda seen: seen.state == "RUNNING",
    "resume_s": lambda seen: seen.task_status == "RUNNING_TASK",
    "drive_s": lambda seen: seen.command_mps > 0,
}


def _stopped_by(error: str) -> Awaited:
    return {
        "error_s": lambda seen: error in seen.errors,
        "pause_s": lambda seen: seen.task_status == "PAUSED_TASK",
        "zero_s": lambda seen: seen.command_mps == 0,
    }


class _FailedError(Exception):
    """The run failed; the message says why."""


async def measure_run(robot: Robot, trigger: Trigger, number: int, random: Random) -> Run:
    """Stop a robot that drives, and start it again.

    Args:
        robot: The robot; it may be in any state.
        trigger: What stops it.
        number: Number of the run.
        random: Decides the phases of the readings.

    Returns:
        The run; it has failed if something was not seen in time, too early, or beside it.

    Raises:
        LostServiceError: The service is gone.
    """
    started_at = datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
    measuring = _Measuring(robot, trigger, random)
    reason = ""
    try:
        await measuring.run()
    except _FailedError as error:
        reason = str(error)
    persistence_s = trigger.persistence_s(robot.settings)
    return Run(number, trigger.error, started_at, persistence_s, measuring.times, reason)


class _Measuring:
    """The steps of one run."""

    def __init__(self, robot: Robot, trigger: Trigger, random: Random) -> None:
        self.times: dict[str, float] = {}
        self._robot = robot
        self._trigger = trigger
        self._random = random
        self._feed = _Feed(robot)

    async def run(self) -> None:
        """Drive, stop, start.

        Raises:
            _FailedError: Something was not as expected.
        """
        await self._get_going()
        await self._echo("echo_1_s")
        await self._stop()
        await self._pause(self._trigger.min_on_s(self._robot.settings) + _SETTLING_S)
        await self._echo("echo_2_s")
        await self._start()

    async def _get_going(self) -> None:
        robot, feed = self._robot, self._feed
        await feed.repeat()
        persistence_s = self._trigger.persistence_s(robot.settings)
        await robot.drive(SPEED_MPS * (persistence_s + _MARGIN_S))
        until = robot.now() + _START_PATIENCE_S
        if await feed.wait(until, _drives) is None:
            raise _FailedError(f"it did not drive within {_START_PATIENCE_S:g} s{feed.situation()}")
        await self._pause(_SETTLING_S)
        if not feed.latest or not _drives(feed.latest):
            raise _FailedError(f"it stopped before the trigger{feed.situation()}")

    async def _stop(self) -> None:
        feed, trigger = self._feed, self._trigger
        begin = feed.sent_at[trigger.signal]
        if trigger.bad is None:
            feed.silence(trigger.signal)
        else:
            self.times["first_bad_s"] = await feed.send(trigger.signal, trigger.bad)
            if trigger.counts_from is CountsFrom.FIRST_BAD:
                begin = self.times["first_bad_s"]
        self.times["counts_from_s"] = begin
        due = begin + trigger.persistence_s(self._robot.settings)
        awaited = _stopped_by(trigger.error)
        await self._await(awaited, due, trigger.error)
        first = min(awaited, key=self.times.__getitem__)
        if (early_s := due - self.times[first]) > 0:
            raise _FailedError(f"{first.removesuffix('_s')} was seen {early_s:.3f} s too early")

    async def _start(self) -> None:
        signal = self._trigger.signal
        begin = await self._feed.send(signal, GOOD[signal])
        self.times["first_good_s"] = begin
        await self._await(_STARTED, begin, None)

    async def _await(self, awaited: Awaited, due: float, error: str | None) -> None:
        """Note when each of several things is seen first.

        Raises:
            _FailedError: One is not seen within `PATIENCE_S` after `due`, or an error other than
                `error` is raised.
        """
        missing = dict(awaited)

        def note(seen: Seen) -> bool:
            others = set(seen.errors) - {self._trigger.error}
            if others:
                raise _FailedError(f"{', '.join(sorted(others))} was raised")
            for name in [name for name, is_there in missing.items() if is_there(seen)]:
                self.times[name] = seen.at_s
                del missing[name]
            return not missing

        if await self._feed.wait(due + PATIENCE_S, note) is None:
            names = ", ".join(name.removesuffix("_s") for name in missing)
            after = f"after {error} was due" if error else "after the first good reading"
            situation = self._feed.situation()
            raise _FailedError(f"not seen within {PATIENCE_S:g} s {after}: {names}{situation}")

    async def _echo(self, name: str) -> None:
        self.times[name] = await self._robot.echo()
        await self._pause(0)

    async def _pause(self, least_s: float) -> None:
        """Wait, and go on sending readings."""
        until = self._robot.now() + least_s + self._random.uniform(0, _PHASE_S)
        await self._feed.wait(until, lambda _: False)


class _Feed:
    """Repeats the readings of all signals, as their sources do; else they would become stale."""

    def __init__(self, robot: Robot) -> None:
        self.sent_at: dict[str, float] = {}
        """When the newest reading of each signal was sent."""
        self.latest: Seen | None = None
        self._robot = robot
        self._values = dict(GOOD)
        self._next_at = robot.now()

    async def send(self, signal: str, value: float | bool | str) -> float:
        """Send another value from now on; return when it was sent first."""
        self._values[signal] = value
        self.sent_at[signal] = sent_at = await self._robot.send(signal, value)
        # What follows from it is not to wait behind the next repetition.
        self._next_at = sent_at + _PERIOD_S
        return sent_at

    def silence(self, signal: str) -> None:
        """Send nothing more of a signal."""
        del self._values[signal]

    async def repeat(self) -> None:
        """Send the readings of all signals."""
        for signal, value in self._values.items():
            self.sent_at[signal] = await self._robot.send(signal, value)
        self._next_at = self._robot.now() + _PERIOD_S

    async def wait(self, until: float, awaited: Callable[[Seen], bool]) -> Seen | None:
        """Send readings until something is seen; None: it was not until then."""
        while True:
            seen = await self._robot.seen(min(until, self._next_at))
            if seen is not None:
                self.latest = seen
                if awaited(seen):
                    return seen
            elif self._robot.now() >= until:
                return None
            else:
                await self.repeat()

    def situation(self) -> str:
        """Return what was seen last, for a message."""
        if self.latest is None:
            return ": no frame came"
        seen = self.latest
        what = " ".join((seen.state, *seen.errors, seen.task_status))
        return f" (last seen: {what}, commanded {seen.command_mps:g} m/s)"


def _drives(seen: Seen) -> bool:
    is_well = seen.state == "RUNNING" and seen.task_status == "RUNNING_TASK"
    return is_well and seen.command_mps >= _UP_TO_SPEED_MPS
