"""Settings of rules, and the bounds that keep them from fighting."""

from dataclasses import dataclass

from domain.timebase import Duration, seconds

WINDOW = seconds(60)
"""Time within which the bounds hold."""
RETRY = seconds(1)
"""Time after which it is judged anew whether a part can return."""
MIN_RELIEF = seconds(1)
"""Shortest time for which guards must hold before a part returns to the mode that they guard."""
HEARD_WITHIN = seconds(2)
"""Time after a restart within which signals and nodes are heard of: until then, what is unknown
breaks no invariant of a mode in force."""
MAX_RETURNS = 3
"""Largest number of times that a part returns to its requested target by itself."""
MAX_FIRINGS = MAX_RETURNS + 1
"""Largest number of times that one rule sets a target: once more than the system may return, so
that a part that keeps failing leaves its system degraded."""


@dataclass(frozen=True, slots=True)
class RuleSettings:
    """When rules of the model act."""

    grace: Duration = seconds(1)
    """How long a deviation must last before a rule acts on it, and how long its cause must be gone
    before the system returns to its requested target."""
