"""A robot that is nothing but its signals, for stories told in seconds."""

from collections.abc import Iterable
from dataclasses import replace

from domain.health.health_changes import HealthChanges
from domain.health.signal_monitor import StopCause
from domain.health.signals import SignalSettings, default_signals
from domain.health.state_manager import StateManager
from domain.inputs import Reading, Readings, SignalValue
from domain.snapshot import ErrorKey, TaskStatus
from domain.timebase import seconds

START = seconds(500)
_GOOD: dict[str, SignalValue] = {
    "battery_level": 1.0,
    "estop": False,
    "gps_accuracy": 100.0,
    "signal_strength": "CONNECTED",
    "temperature": 20.0,
}


class Robot:
    """A state manager whose times are seconds after its start."""

    def __init__(self, settings: Iterable[SignalSettings]) -> None:
        self.health = StateManager(settings, START)

    def read(self, at_s: float, source: str = "pad", **values: SignalValue) -> HealthChanges:
        items = tuple(Reading(signal, value) for signal, value in values.items())
        return self.take(at_s, *items, source=source)

    def take(self, at_s: float, *items: Reading, source: str = "pad") -> HealthChanges:
        readings, now = Readings(items, source), START + seconds(at_s)
        self.health.check(readings, now)
        return self.health.receive(readings, now)

    def be_well(self, at_s: float) -> HealthChanges:
        return self.take(at_s, *(Reading(signal, value) for signal, value in _GOOD.items()))

    def pass_time(self, at_s: float) -> HealthChanges:
        return self.health.pass_time(START + seconds(at_s))

    def acknowledge(self, at_s: float, error: str) -> HealthChanges:
        return self.health.acknowledge(ErrorKey(None, error), START + seconds(at_s))

    def engage(self, at_s: float, engaged: bool = True) -> HealthChanges:
        now = START + seconds(at_s)
        causes = (StopCause("emergency stop is engaged", now),) if engaged else ()
        return self.health.set_emergency_stop(causes, now)

    @property
    def errors(self) -> tuple[str, ...]:
        return self.health.errors

    @property
    def words(self) -> list[str]:
        return [reason.message for reason in self.health.system_state(TaskStatus.NO_TASK).reasons]


def never_stale() -> list[SignalSettings]:
    return [replace(item, stale_after=0) for item in default_signals()]
