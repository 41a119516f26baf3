"""Limits by mode: which values of a signal are bad while a part is in a mode."""

from collections.abc import Iterator, Mapping
from typing import Self

from pydantic import model_validator

from domain.health.signals import Bound, Comparison, ModeLimit
from domain.state_and_mode import ModeName, PartName
from domain.timebase import seconds
from service.files.settings_block import Number, Seconds, SettingsBlock

DEFAULT = "default"
"""The key of the limits in all modes of which nothing is said."""


class LimitKeys(SettingsBlock):
    """Limits of a signal; without `above` and `below`, no value is bad."""

    above: Number | None = None
    """A value above this is an error."""
    below: Number | None = None
    """A value below this is an error."""
    clear_threshold: Number | None = None
    """Threshold at which an active error clears. Default: `above` or `below`."""

    @model_validator(mode="after")
    def _has_one_side(self) -> Self:
        if self.above is not None and self.below is not None:
            raise ValueError("above and below are mutually exclusive")
        if self.clear_threshold is not None and self.above is None and self.below is None:
            raise ValueError("clear_threshold requires above or below")
        return self

    def bound(self, error: str, for_s: float) -> Bound | None:
        """Return which values are an error; None: none is.

        Args:
            error: Its name.
            for_s: Time until it is raised, in seconds.
        """
        comparison = Comparison.BELOW if self.above is None else Comparison.ABOVE
        threshold = self.below if self.above is None else self.above
        if threshold is None:
            return None
        return Bound(error, comparison, threshold, self.clear_threshold, seconds(for_s))


class ModeLimitKeys(LimitKeys):
    """Limits while a part is in a mode."""

    for_s: Seconds | None = None
    """Time until the error is raised, counted from the change of limits at the earliest. Default:
    that of the signal."""


def mode_limits(
    limits: Mapping[str, ModeLimitKeys], error: str, for_s: float
) -> Iterator[ModeLimit]:
    """Yield limits for the core, in the order of the file.

    Args:
        limits: By part and mode, such as `drive_base.FAST`, or `default`.
        error: Name of the error.
        for_s: Time until it is raised, in seconds, where a limit does not say.
    """
    for key, keys in limits.items():
        bound = keys.bound(error, for_s if keys.for_s is None else keys.for_s)
        if key == DEFAULT:
            yield ModeLimit(bound)
        else:
            part, mode = part_and_mode(key)
            yield ModeLimit(bound, part, mode)


def part_and_mode(key: str) -> tuple[PartName, ModeName]:
    """Return what a key such as `left/arm.FAST` names; without a dot, the mode is empty."""
    part, dot, mode = key.lstrip("/").rpartition(".")
    return (PartName(part), ModeName(mode)) if dot else (PartName(mode), ModeName(""))
