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


def severity_of(key: ErrorKey) -> Severity:
    """Return the severity of an error of which nothing else is said.

    Each of the robot itself sets a bit, and so ERROR.
    """
    if key.part is None:
        return Severity.CRITICAL
    return OF_NODES.get(key.error, Severity.WARNING)
