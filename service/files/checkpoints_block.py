"""The block `checkpoints` of a node in a robot file: what is supervised of its program."""

from math import ceil, floor
from typing import Annotated, Self, TypeAlias

from pydantic import Field, model_validator

from domain.health.checkpoints import AliveLimits, CheckpointDeadline, CheckpointSettings
from domain.timebase import seconds
from service.files.settings_block import Seconds, SettingsBlock

MAX_COUNT = 10_000
"""Times that a checkpoint may be reached in its window; so many are remembered."""

_ROUNDING = 9
"""Decimals of a count: 0.7 s at 30 Hz are 21 times, and not a little less."""

Checkpoint: TypeAlias = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,63}$")]
_Rate: TypeAlias = Annotated[float, Field(gt=0, le=10_000, allow_inf_nan=False)]
_Time: TypeAlias = Annotated[float, Field(ge=0.001, le=86_400, allow_inf_nan=False)]


class AliveBlock(SettingsBlock):
    """How often a checkpoint has to be reached; one of the two rates at least."""

    min_hz: _Rate | None = None
    """Lowest rate; below it the error is CHECKPOINT_TOO_FEW."""
    max_hz: _Rate | None = None
    """Highest rate; above it the error is CHECKPOINT_TOO_MANY."""
    window_s: _Time = 1.0
    """Time over which it is counted, in seconds."""

    @model_validator(mode="after")
    def _can_be_kept(self) -> Self:
        if self.min_hz is None and self.max_hz is None:
            raise ValueError("expected min_hz, max_hz or both")
        least, most = self._at_least(), self._at_most()
        if most == 0:
            raise ValueError("max_hz allows none in window_s; a longer window is needed")
        if most is not None and least > most:
            raise ValueError("min_hz and max_hz leave no number of times in window_s")
        if max(least, most or 0) > MAX_COUNT:
            raise ValueError(f"more than {MAX_COUNT:,} times in window_s")
        return self

    def to_domain(self, checkpoint: str) -> AliveLimits:
        """Return the limits for the core."""
        window = seconds(self.window_s)
        return AliveLimits(checkpoint, window, self._at_least(), self._at_most())

    def _at_least(self) -> int:
        return 0 if self.min_hz is None else ceil(round(self.min_hz * self.window_s, _ROUNDING))

    def _at_most(self) -> int | None:
        return None if self.max_hz is None else floor(round(self.max_hz * self.window_s, _ROUNDING))


class DeadlineBlock(SettingsBlock):
    """How long it may take from one checkpoint to another one."""

    begin: Checkpoint = Field(alias="from")
    """The checkpoint with which the time begins."""
    end: Checkpoint = Field(alias="to")
    """The checkpoint that has to follow."""
    within_s: _Time
    """Longest time between them, in seconds; after it the error is CHECKPOINT_LATE."""

    @model_validator(mode="after")
    def _has_two_ends(self) -> Self:
        if self.begin == self.end:
            raise ValueError("from and to are the same; min_hz of alive supervises one alone")
        return self


class CheckpointsBlock(SettingsBlock):
    """What is supervised of the checkpoints of a node, while the node is active.

    Every checkpoint that is named here can be reported.
    """

    alive: dict[Checkpoint, AliveBlock] = Field(default_factory=dict)
    """By checkpoint, how often it has to be reached."""
    deadlines: dict[Checkpoint, DeadlineBlock] = Field(default_factory=dict)
    """By a name of your choice, how long it may take from one checkpoint to another one."""
    order: dict[Checkpoint, list[Checkpoint]] = Field(default_factory=dict)
    """By checkpoint, which ones may come next; another one is the error CHECKPOINT_WRONG_ORDER.
    Checkpoints that are not named here may come at any time."""
    clear_for_s: Seconds = 1.0
    """Time in seconds for which all has to be well before an error clears."""

    @model_validator(mode="after")
    def _names_some(self) -> Self:
        if not (self.alive or self.deadlines or self.order):
            raise ValueError("expected alive, deadlines or order")
        return self

    def to_domain(self) -> CheckpointSettings:
        """Return the settings for the core."""
        return CheckpointSettings(
            tuple(block.to_domain(name) for name, block in self.alive.items()),
            tuple(
                CheckpointDeadline(block.begin, block.end, seconds(block.within_s))
                for block in self.deadlines.values()
            ),
            {before: tuple(dict.fromkeys(after)) for before, after in self.order.items()},
            seconds(self.clear_for_s),
        )
