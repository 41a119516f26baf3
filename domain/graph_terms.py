"""What can be wrong in the ROS graph."""

from dataclasses import dataclass
from enum import StrEnum


class GraphFaultKind(StrEnum):
    """What is wrong in the ROS graph."""

    QOS = "qos"
    """The ends of a topic have incompatible quality of service."""
    TYPE = "type"
    """The ends of a topic have different message types."""
    DUPLICATE = "duplicate"
    """Two nodes have one name."""


@dataclass(frozen=True, slots=True)
class GraphFault:
    """Something in the ROS graph keeps messages away, or makes two nodes one; or it is gone."""

    kind: GraphFaultKind
    name: str
    """Full name of the topic, or of the node."""
    reason: str = ""
    """What is wrong; empty: it is right again."""
