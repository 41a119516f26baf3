"""The errors that parts have without a word in the model file."""

from collections.abc import Mapping
from types import MappingProxyType

from domain.snapshot import ErrorKey, Severity

UNREACHABLE = "UNREACHABLE"
ERROR_PROCESSING = "ERROR_PROCESSING"
PARAMETERS_DRIFTED = "PARAMETERS_DRIFTED"
DEVIATES = "DEVIATES"
CHANGE_FAILED = "CHANGE_FAILED"
INVARIANT_BROKEN = "INVARIANT_BROKEN"
CHECKPOINT_TOO_FEW = "CHECKPOINT_TOO_FEW"
CHECKPOINT_TOO_MANY = "CHECKPOINT_TOO_MANY"
CHECKPOINT_LATE = "CHECKPOINT_LATE"
CHECKPOINT_WRONG_ORDER = "CHECKPOINT_WRONG_ORDER"
PROCESS_ENDED = "PROCESS_ENDED"
PROCESS_GIVEN_UP = "PROCESS_GIVEN_UP"
LATE = "LATE"
LOST = "LOST"
DEVICE_CONFLICT = "DEVICE_CONFLICT"

OF_EVERY_PART: Mapping[str, Severity] = MappingProxyType(
    {
        DEVIATES: Severity.WARNING,
        CHANGE_FAILED: Severity.WARNING,
        INVARIANT_BROKEN: Severity.WARNING,
    }
)
"""The errors of systems, with their severities; nodes have them as well."""

OF_NODES: Mapping[str, Severity] = MappingProxyType(
    {
        UNREACHABLE: Severity.URGENT,
        ERROR_PROCESSING: Severity.URGENT,
        PARAMETERS_DRIFTED: Severity.WARNING,
        **OF_EVERY_PART,
    }
)
"""The errors of nodes, in the order in which they are shown."""

OF_CHECKPOINTS: Mapping[str, Severity] = MappingProxyType(
    {
        CHECKPOINT_TOO_FEW: Severity.WARNING,
        CHECKPOINT_TOO_MANY: Severity.WARNING,
        CHECKPOINT_LATE: Severity.WARNING,
        CHECKPOINT_WRONG_ORDER: Severity.WARNING,
    }
)
"""The errors of nodes whose checkpoints are supervised, besides those of every node."""

OF_PROCESSES: Mapping[str, Severity] = MappingProxyType(
    {PROCESS_ENDED: Severity.URGENT, PROCESS_GIVEN_UP: Severity.URGENT}
)
"""The errors of nodes whose process is run here, besides those of every node."""

ALL_OF_NODES: Mapping[str, Severity] = MappingProxyType(
    # What explains that a node is unreachable is decided first.
    {**OF_PROCESSES, **OF_NODES, **OF_CHECKPOINTS}
)
"""The errors that any node may have without a word in the model file."""

OF_DEVICES: Mapping[str, Severity] = MappingProxyType(
    {LATE: Severity.WARNING, LOST: Severity.URGENT, DEVICE_CONFLICT: Severity.URGENT}
)
"""The errors of the devices of a robot, which are no parts, but share their names with none."""


def severity_of(key: ErrorKey) -> Severity:
    """Return the severity of an error of which nothing else is said.

    Each of the robot itself sets a bit, and so ERROR.
    """
    if key.part is None:
        return Severity.CRITICAL
    return ALL_OF_NODES.get(key.error, Severity.WARNING)
