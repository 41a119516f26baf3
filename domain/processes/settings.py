"""Settings of the process of a node."""

from dataclasses import dataclass

from domain.process_terms import RestartPolicy
from domain.timebase import Duration, seconds


@dataclass(frozen=True, slots=True)
class ProcessSettings:
    """When the process of a node is started again."""

    restart: RestartPolicy = RestartPolicy.ON_FAILURE
    first_back_off: Duration = seconds(0.5)
    """Time from an end to the next start; it doubles with each end that follows."""
    most_back_off: Duration = seconds(30)
    """It grows no longer than this, and is `first_back_off` again after a run of this length."""
    starts: int = 5
    """How often it is started within `within` before it is given up; at least 1."""
    within: Duration = seconds(60)
