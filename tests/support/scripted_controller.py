"""An external controller in virtual time, honest or not, and a robot that it drives."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from domain.commands import Drive, PreemptGoal, SendGoal
from domain.controller import (
    ControllerAnswer,
    ControllerFeedback,
    ControllerMessage,
    ControllerResult,
    ControllerSettings,
    ControllerStatus,
    GoalOutcome,
)
from domain.external_navigation import ExternalNavigation
from domain.inputs import GoalFeedback, Input
from domain.navigation import Navigation, NavigationSettings
from domain.onboard import Onboard
from domain.outbox import Outputs
from domain.parts.system_model import SmhModel
from domain.simulation.vehicle_settings import VehicleSettings
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import Instant, seconds
from domain.vehicle import COMMAND_VALID_FOR, VehicleLimits
from service.codec.recorded_step import RecordedStep, recorded_step
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD

ACTION = "/navigate_waypoints"


@dataclass
class Manners:
    """How a controller behaves; by default as it should."""

    answers: bool = True
    accepts: bool = True
    reports: bool = True
    heeds_cancel: bool = True
    index_offset: int = 0
    """Added to the waypoint that it reports."""
    progress: float | None = None
    """What it reports as its progress; None: what is so."""
    reaches_at_m: float | None = None
    """It says that it arrived at this distance, and drives on; None: at the end."""
    aborts_at_m: float | None = None


class ScriptedController:
    """A controller that follows paths with the trackers of Pilothouse, in a process of its own."""

    def __init__(self, onboard: Onboard) -> None:
        self.manners = Manners()
        self.is_dead = False
        self.given: list[SendGoal] = []
        """Every goal that it was sent."""
        self.asked_back = 0
        self._watch = onboard.core.driving.watch
        self._navigation = self._make()
        self._goal: SendGoal | None = None
        self._said: list[ControllerMessage] = []

    @property
    def goal(self) -> SendGoal | None:
        """Return the goal that it drives; None: none."""
        return self._goal

    def take(self, command: SendGoal | PreemptGoal, now: Instant) -> None:
        """Take what it is sent; a dead one takes nothing."""
        if self.is_dead:
            return
        if isinstance(command, SendGoal):
            self.given.append(command)
            self._take_goal(command, now)
            return
        self.asked_back += 1
        if not self.manners.heeds_cancel:
            return
        if self._goal is None or self._goal.goal != command.goal:
            self._said.append(ControllerResult(command.goal, GoalOutcome.UNKNOWN))
            return
        self._end(GoalOutcome.CANCELED)

    def die(self) -> None:
        """End without a word, as after `kill -9`."""
        self.is_dead = True
        self._goal, self._navigation = None, self._make()
        self._said.clear()

    def start_again(self) -> None:
        """Start as a new process that knows no goal."""
        self.is_dead = False

    def hear(self) -> list[ControllerMessage]:
        """Return what it said since the last call."""
        said, self._said = self._said, []
        return said

    def wake_at(self) -> Instant | None:
        """Return when it does its next control step."""
        return self._navigation.wake_at()

    def advance(self, now: Instant) -> Iterator[Drive]:
        """Do what is due; yield how it commands the vehicle."""
        for message in self._navigation.advance(now):
            if isinstance(message, Drive):
                yield message
            elif isinstance(message, GoalFeedback):
                self._report(message)
            elif self._goal is not None:
                end = GoalOutcome.SUCCEEDED if message.succeeded else GoalOutcome.ABORTED
                self._end(end, message.reason)

    def _make(self) -> Navigation:
        return Navigation(VehicleLimits(), NavigationSettings(), self._watch)

    def _take_goal(self, command: SendGoal, now: Instant) -> None:
        if not self.manners.answers:
            return
        accepts = self.manners.accepts
        reason = "" if accepts else "its map has no such place"
        self._said.append(ControllerAnswer(command.goal, accepts, reason))
        if accepts:
            self._goal = command
            self._navigation.handle(command, now)

    def _report(self, told: GoalFeedback) -> None:
        goal, manners = self._goal, self.manners
        if goal is None:
            return
        if manners.reports:
            index = told.target_index + manners.index_offset
            share = told.distance_m / goal.path.length_m
            progress = share if manners.progress is None else manners.progress
            self._said.append(ControllerFeedback(goal.goal, index, progress))
        if manners.aborts_at_m is not None and told.distance_m >= manners.aborts_at_m:
            self._end(GoalOutcome.ABORTED, "an obstacle does not move")
        elif manners.reaches_at_m is not None and told.distance_m >= manners.reaches_at_m:
            self._said.append(ControllerResult(goal.goal, GoalOutcome.SUCCEEDED))
            manners.reaches_at_m = None

    def _end(self, end: GoalOutcome, reason: str = "") -> None:
        assert self._goal is not None
        self._said.append(ControllerResult(self._goal.goal, end, reason))
        self._goal, self._navigation = None, self._make()


class ControlledRobot(CoreRobot):
    """A robot that an external controller drives, unless Pilothouse commands its vehicle.

    As a multiplexer of commands does: what Pilothouse commands goes before for as long as it is
    valid.
    """

    def __init__(
        self,
        settings: ControllerSettings | None = None,
        vehicle: VehicleSettings | None = None,
        *,
        is_there: bool = True,
    ) -> None:
        self._settings = settings or ControllerSettings(ACTION)
        self._stopped_at: Instant | None = None
        self.taken: list[RecordedStep] = []
        """Each input, and what followed from it."""
        super().__init__(SmhModel({}, {}), vehicle=vehicle)
        self.read(**GOOD)
        if is_there:
            self.give(ControllerStatus(available=True))
        self.commands.clear()

    def make(
        self, model: SmhModel, start: Instant, settings: SupervisionSettings | None
    ) -> Onboard:
        """Return a core whose goals go to the controller."""
        onboard = make_controlled(model, start, settings, self._settings)
        self.controller = ScriptedController(onboard)
        return onboard

    def give(self, given: Input) -> Outputs:
        """Hand one input to the core, and what it asks to the vehicle and the controller."""
        outputs = self.onboard.handle(given, self.now)
        self.taken.append(recorded_step(self.now, given, False, outputs))
        self.events += outputs.events
        for command in outputs.commands:
            self.commands.append(command)
            if isinstance(command, SendGoal | PreemptGoal):
                self.controller.take(command, self.now)
            elif isinstance(command, Drive):
                self._stopped_at = self.now
                self.robot.vehicle.drive(command.command, self.now)
        return outputs

    def advance(self, duration_s: float) -> None:
        """Let time pass, for the controller too."""
        end = self.now + seconds(duration_s)
        while True:
            sources = (self.robot, self.onboard, self.controller)
            due = [at for at in (source.wake_at() for source in sources) if at is not None]
            if min(due) > end:
                break
            self.now = max(self.now, min(due))
            for message in self.robot.advance(self.now):
                self.give(message)
            for command in self.controller.advance(self.now):
                self._drive(command)
            self.hear_controller()
            self._let_core_wake()
            self.hear_controller()
        self.now = end

    def hear_controller(self) -> None:
        """Hand to the core what the controller said."""
        while said := self.controller.hear():
            for message in said:
                self.give(message)

    def drive(self, by_s: float) -> None:
        """Let time pass with good readings twice a second."""
        for _ in range(round(by_s / 0.5)):
            self.advance(0.5)
            self.read(**GOOD)

    def be(self, **manners: object) -> None:
        """Let the controller behave so from now on."""
        self.controller.manners = replace(self.controller.manners, **manners)  # type: ignore[arg-type]

    @property
    def holds(self) -> dict[str, str]:
        """Return the reason of each hold."""
        return {name: hold.reason for name, hold in self.core.driving.holds.items()}

    @property
    def speed_mps(self) -> float:
        """Return the speed that the vehicle reports."""
        state = self.core.driving.vehicle.state
        assert state is not None
        return state.speed_mps

    def _drive(self, command: Drive) -> None:
        stopped_at = self._stopped_at
        if stopped_at is None or self.now - stopped_at >= COMMAND_VALID_FOR:
            self.robot.vehicle.drive(command.command, self.now)


def make_controlled(
    model: SmhModel,
    start: Instant = 0,
    settings: SupervisionSettings | None = None,
    controller: ControllerSettings | None = None,
) -> Onboard:
    """Return a core whose goals go to a controller."""
    settings = settings or SupervisionSettings()
    core = Supervision(model, settings, start)
    navigation = ExternalNavigation(
        settings.vehicle,
        NavigationSettings(),
        controller or ControllerSettings(ACTION),
        core.driving.watch,
        start,
    )
    return Onboard(core, navigation)
