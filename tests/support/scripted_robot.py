"""The supervision alone, with a test as its sensors, its vehicle and its navigation."""

from collections.abc import Mapping
from typing import Any, TypeVar

from domain.commands import Command, Drive, PreemptGoal, SendGoal
from domain.events.event import RecordedEvent
from domain.identifiers import ChangeId, TaskId
from domain.inputs import (
    ChangeRequest,
    GoalFeedback,
    GoalResult,
    Input,
    TimePassed,
    VehicleReport,
)
from domain.kept import Kept, KeptProgress
from domain.outbox import Outputs
from domain.parts.system_model import SmhModel
from domain.snapshot import TaskView
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import Instant, seconds
from domain.vehicle import DriveCommand, Point, Pose, VehicleState
from tests.support.good import GOOD
from tests.support.operator_verbs import OperatorVerbs, change_of

AnyCommand = TypeVar("AnyCommand", bound=Command)


class ScriptedRobot(OperatorVerbs[Outputs, ChangeId, None]):
    """A robot whose readings are good and whose vehicle stands at the origin, unless told."""

    def __init__(
        self,
        *,
        pose: bool = True,
        good: bool = True,
        settings: SupervisionSettings | None = None,
        start: Instant = 0,
    ) -> None:
        self.now = start
        self.core = Supervision(SmhModel({}, {}), settings or SupervisionSettings(), start)
        self.events: list[RecordedEvent] = []
        self.commands: list[Command] = []
        self.kept: dict[tuple[type[Kept], str], Kept | None] = {}
        """What the core wants to be kept; None: it is forgotten."""
        if good:
            self.read(**GOOD)
        if pose:
            self.report()
        self.events.clear()
        self.commands.clear()

    def give(self, given: Input) -> Outputs:
        """Hand one input to the core."""
        outputs = self.core.handle(given, self.now)
        self.events += outputs.events
        self.commands += outputs.commands
        self.kept |= {(item.kind, item.name): item.value for item in outputs.kept}
        return outputs

    def begin(self, request: ChangeRequest) -> ChangeId:
        """Ask for a change and return it."""
        return change_of(self.give(request))

    def advance(self, duration_s: float, speed_mps: float = 0.0) -> None:
        """Let time pass, with good readings and the vehicle's reports at 20 Hz."""
        for _ in range(round(duration_s / 0.05)):
            self.now += seconds(0.05)
            self.read(**GOOD)
            self.report(speed_mps)

    def stay_silent(self, duration_s: float) -> None:
        """Let time pass without a reading or a report."""
        self.now += seconds(duration_s)
        self.give(TimePassed())

    def report(self, speed_mps: float = 0.0, x_m: float = 0.0, steering_rad: float = 0.0) -> None:
        """Let the vehicle say where it is."""
        pose = Pose(x_m, 0.0, 0.0)
        self.give(VehicleReport(VehicleState(pose, speed_mps, steering_rad)))

    # --- navigation ------------------------------------------------------------------------------

    def feedback(self, target_index: int, goal: SendGoal | None = None) -> Outputs:
        """Let navigation say that it is right before a waypoint of a path with 1 m spacing."""
        sent = goal or self.goals[-1]
        command, point = DriveCommand(2.8, 0.1), Point(target_index + 3.0, 0.0)
        distance_m = max(target_index - 0.5, 0.0)
        given = GoalFeedback(sent.goal, target_index, distance_m, 0.02, point, command)
        return self.give(given)

    def arrive(self, *, succeeded: bool = True, reason: str = "") -> Outputs:
        """Let navigation end its goal."""
        return self.give(GoalResult(self.goals[-1].goal, succeeded, reason))

    # --- what is kept ----------------------------------------------------------------------------

    def progress(self, task: str = "t1") -> KeptProgress:
        """Return the progress of a task that is kept."""
        kept = self.kept[KeptProgress, TaskId(task)]
        assert isinstance(kept, KeptProgress)
        return kept

    def all_kept(self) -> tuple[Kept, ...]:
        """Return all that is kept."""
        return tuple(kept for kept in self.kept.values() if kept is not None)

    # --- what is seen ----------------------------------------------------------------------------

    @property
    def goals(self) -> list[SendGoal]:
        """Return the goals that were sent."""
        return self.sent(SendGoal)

    @property
    def preempted(self) -> list[PreemptGoal]:
        """Return the goals that were taken back."""
        return self.sent(PreemptGoal)

    @property
    def stops(self) -> int:
        """Return how often speed 0 was commanded."""
        return sum(drive.command.speed_mps == 0 for drive in self.sent(Drive))

    def sent(self, kind: type[AnyCommand]) -> list[AnyCommand]:
        """Return the commands of a kind."""
        return [command for command in self.commands if isinstance(command, kind)]

    @property
    def task(self) -> TaskView:
        """Return the task that was served last."""
        return next(iter(self.core.driving.tasks()))

    @property
    def status(self) -> str:
        """Return the status of the task planner."""
        return str(self.core.system_state().task_status)

    @property
    def state(self) -> str:
        """Return IDLE, RUNNING or ERROR."""
        return str(self.core.system_state().state)

    def happened(self, kind: str) -> list[Mapping[str, Any]]:
        """Return the data of all events of a kind."""
        return [event.data for event in self.events if event.kind == kind]
