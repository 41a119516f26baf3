"""A robot for `pilothouse profile` whose time passes only while it is watched."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from api.profiling.robot import LostServiceError, Seen
from api.profiling.triggers import GOOD, TRIGGERS, Settings
from domain.health.signals import CountsFrom, default_signals

SETTINGS: Settings = {settings.spec.name: settings.facts() for settings in default_signals()}
"""The defaults, as `GET /signals` shows them."""


@dataclass
class ProfiledRobot:
    """Implements `Robot`: decides as the service does, each time `delay_s` late."""

    delay_s: float = 0.002
    settings: Settings = field(default_factory=lambda: SETTINGS)
    deaf_to: frozenset[str] = frozenset()
    """Errors that it never raises."""
    early_s: Mapping[str, float] = field(default_factory=dict)
    """How much too early it raises an error."""
    beside: Mapping[str, str] = field(default_factory=dict)
    """An error that comes with another one."""
    ends_after: int | None = None
    """After so many tasks the service is gone."""
    never_starts: bool = False
    drives: int = 0
    sent: list[tuple[float, str, object]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._now = 1000.0
        self._values: dict[str, object] = {}
        self._good_at: dict[str, float] = {}
        self._read_at: dict[str, float] = {}
        self._bad_at: dict[str, float] = {}
        self._shown: tuple[str, ...] | None = None
        """Errors of the latest frame; None: the next one is due anyhow."""
        self._shown_at = self._touched_at = self._now
        """When these errors were decided, and when readings changed them last."""

    def now(self) -> float:
        """Return its time, s."""
        return self._now

    async def drive(self, length_m: float) -> None:
        """Begin to drive, unless it never does."""
        assert length_m > 0
        self.drives += 1
        self._shown = None
        self._touched_at = self._now

    async def send(self, signal: str, value: float | bool | str) -> float:
        """Take a reading."""
        before = self._errors(self._now)
        self.sent.append((self._now, signal, value))
        self._values[signal] = value
        self._read_at[signal] = self._now
        if value == GOOD[signal]:
            self._good_at[signal] = self._now
            self._bad_at.pop(signal, None)
        else:
            self._bad_at.setdefault(signal, self._now)
        if self._errors(self._now) != before:
            self._touched_at = self._now
        return self._now

    async def echo(self) -> float:
        """Answer in half the time of a decision."""
        self._now += self.delay_s / 2
        return self.delay_s / 2

    async def seen(self, until: float) -> Seen | None:
        """Let time pass up to the next frame, or to `until`."""
        if self.ends_after is not None and self.drives > self.ends_after:
            raise LostServiceError("gone")
        moment = self._next_change()
        if moment is None or moment + self.delay_s > until:
            self._now = max(until, self._now)
            return None
        self._shown, self._shown_at = self._errors(moment), moment
        self._now = max(self._now, moment + self.delay_s)
        return self._frame(self._shown)

    def _next_change(self) -> float | None:
        """Return when other errors than those of the latest frame are decided."""
        dues = [due for error in TRIGGERS if (due := self._due(error)) is not None]
        for moment in sorted([self._touched_at, *dues]):
            if moment >= self._shown_at and self._errors(moment) != self._shown:
                return moment
        return None

    def _frame(self, errors: tuple[str, ...]) -> Seen:
        if errors:
            return Seen(self._now, "ERROR", errors, "PAUSED_TASK", 0.0)
        command_mps = 0.0 if self.never_starts else 2.8
        return Seen(self._now, "RUNNING", (), "RUNNING_TASK", command_mps)

    def _due(self, error: str) -> float | None:
        """Return when an error is raised; None: there is no reason to."""
        trigger = TRIGGERS[error]
        signal = trigger.signal
        if error in self.deaf_to or signal not in self._values:
            return None
        lasting_s = trigger.persistence_s(self.settings) - self.early_s.get(error, 0.0)
        if trigger.bad is None:
            return self._read_at[signal] + lasting_s
        if self._values[signal] != trigger.bad:
            return None
        from_last_good = trigger.counts_from is CountsFrom.LAST_GOOD
        return (self._good_at if from_last_good else self._bad_at)[signal] + lasting_s

    def _errors(self, at: float) -> tuple[str, ...]:
        on = [name for name in TRIGGERS if (due := self._due(name)) is not None and due <= at]
        return (*on, *(self.beside[name] for name in on if name in self.beside))
