"""What an operator asks of a robot, in the same words wherever the robot is reached.

A verb is one input of the core. A robot says how an input gets there: into the core itself, through
the service, or over HTTP.
"""

from abc import ABC, abstractmethod
from typing import Generic, TypeVar

from domain.actor import Actor
from domain.identifiers import ChangeId
from domain.inputs import (
    AcknowledgeRequest,
    CancelTaskRequest,
    ChangeRequest,
    EmergencyStopRequest,
    HoldRequest,
    Input,
    ModeRequest,
    Reading,
    Readings,
    ReleaseRequest,
    SignalValue,
    TaskRequest,
    TransitionRequest,
)
from domain.lifecycle import Transition
from domain.outbox import Outputs
from domain.paths.path import Path
from domain.state_and_mode import PartName
from tests.support.paths import straight

Answer = TypeVar("Answer")
Change = TypeVar("Change")
Passed = TypeVar("Passed")


class OperatorVerbs(ABC, Generic[Answer, Change, Passed]):
    """A robot as its operator uses it.

    `Answer` is what a verb returns, `Change` what a change is found by, `Passed` what is returned
    when time has passed; over a network all three are awaited.
    """

    source = "test"
    """Who measured what is read."""

    @abstractmethod
    def give(self, given: Input) -> Answer:
        """Hand in an input; one that is refused raises."""

    @abstractmethod
    def begin(self, request: ChangeRequest) -> Change:
        """Ask for a change, which is not refused."""

    @abstractmethod
    def advance(self, duration_s: float) -> Passed:
        """Let time pass, and happen what is due in it."""

    def read(self, **values: SignalValue) -> Answer:
        """Hand in one reading of each of these signals."""
        items = tuple(Reading(name, value) for name, value in values.items())
        return self.give(Readings(items, self.source))

    def acknowledge(self, error: str) -> Answer:
        """Acknowledge an error."""
        return self.give(AcknowledgeRequest(error, Actor("operator")))

    def ask_mode(self, part: str, mode: str) -> Change:
        """Ask for a mode of a node or a system."""
        return self.begin(ModeRequest(PartName(part), mode))

    def ask_transition(self, part: str, transition: str) -> Change:
        """Ask for a lifecycle transition of a node or a system."""
        return self.begin(TransitionRequest(PartName(part), Transition(transition)))

    def stop(self, reason: str = "test") -> Answer:
        """Engage the emergency stop."""
        return self.give(EmergencyStopRequest(True, reason, Actor("operator")))

    def release_stop(self, reason: str = "test") -> Answer:
        """Release the emergency stop."""
        return self.give(EmergencyStopRequest(False, reason, Actor("operator")))

    def submit_task(
        self,
        path: Path | None = None,
        *,
        start_index: int = 0,
        controller: str = "pure_pursuit",
        speed_mps: float = 2.8,
    ) -> Answer:
        """Submit a task in place of the current one; without a path it is 20 m straight on."""
        asked = TaskRequest(
            path or straight(), start_index, controller, speed_mps, Actor("operator")
        )
        return self.give(asked)

    def cancel_task(self) -> Answer:
        """Cancel the current task."""
        return self.give(CancelTaskRequest(Actor("operator")))

    def hold(self, owner: str = "operator", reason: str = "lunch") -> Answer:
        """Set a hold."""
        return self.give(HoldRequest(owner, reason, Actor("operator")))

    def release(self, owner: str = "operator") -> Answer:
        """Release a hold."""
        return self.give(ReleaseRequest(owner, Actor("operator")))


def change_of(outputs: Outputs) -> ChangeId:
    """Return the change that an input began."""
    assert outputs.change is not None
    return outputs.change
