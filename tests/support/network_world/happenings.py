"""What may happen to a robot of several computers: each a plain value that a story prints."""

from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

from domain.computers import ComputerName
from domain.inputs import Input
from domain.simulation.network import Wire
from domain.simulation.node_settings import Fault
from domain.state_and_mode import PartName


class Store(StrEnum):
    """What a process that is started again finds on its disk."""

    KEPT = "kept"
    LOST = "lost"
    OLD = "old"
    """A copy of an earlier moment was put back."""


@dataclass(frozen=True)
class WireChanges:
    """One direction between two computers becomes better or worse."""

    sender: ComputerName
    to: ComputerName
    wire: Wire


@dataclass(frozen=True)
class Crash:
    """The process of a computer ends at once; its nodes go on as they are."""

    computer: ComputerName


@dataclass(frozen=True)
class Start:
    """The process of a computer is started, if it does not run."""

    computer: ComputerName
    store: Store = Store.KEPT


@dataclass(frozen=True)
class Sleep:
    """The process of a computer does nothing for a while, and then reads all that came meanwhile.

    As with SIGSTOP, swapping, or a debugger.
    """

    computer: ComputerName
    for_s: float


@dataclass(frozen=True)
class Ask:
    """A person asks something at the page of a computer."""

    computer: ComputerName
    request: Input


@dataclass(frozen=True)
class NodeFault:
    """Something is wrong with a node, or no longer."""

    node: PartName
    fault: Fault | None


@dataclass(frozen=True)
class Newcomer:
    """Another process begins under the name of a computer, with nodes and a store of its own."""

    name: ComputerName


@dataclass(frozen=True)
class NewcomerEnds:
    """The other process of that name ends."""

    name: ComputerName


Happening: TypeAlias = (
    WireChanges | Crash | Start | Sleep | Ask | NodeFault | Newcomer | NewcomerEnds
)
