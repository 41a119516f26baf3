"""The core: one input at a time, in; commands and events, out. It decides everything.

It does no I/O and has no clock. The live service, a simulation and a test hand in the same inputs
and times, and get the same outputs.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import islice

from domain.changes.admission import ChangeAdmission
from domain.changes.operations import Changes
from domain.changes.plan import ChangeGoal, next_steps, presumed_steps
from domain.changes.record import ChangeSettings, Step
from domain.changes.request_check import check_request, describe_request
from domain.changes.restoring import Restoring
from domain.errors import BackendUnavailableError
from domain.findings import Blocker
from domain.health.emergency_stop import EmergencyStop
from domain.health.health_events import HealthEvents
from domain.health.signals import SignalSettings, default_signals
from domain.health.state_manager import HealthChanges, StateManager
from domain.identifiers import ChangeId
from domain.inputs import (
    AcknowledgeRequest,
    BackendStatus,
    CancelRequest,
    CancelTaskRequest,
    ChangeRequest,
    DriveRequest,
    EmergencyStopRequest,
    GoalFeedback,
    GoalResult,
    HoldRequest,
    Input,
    ModeRequest,
    NodeAnswer,
    NodeReport,
    ParametersRequest,
    Readings,
    ReleaseRequest,
    TaskRequest,
    TimePassed,
    TransitionRequest,
    VehicleReport,
    WriteRecord,
)
from domain.lifecycle import LifecycleState, Transition
from domain.outbox import Outbox, Outputs
from domain.parameters import value_type
from domain.parts.mode_inference import ModeInference
from domain.parts.part_views import PartViews
from domain.parts.system_model import SmhModel
from domain.snapshot import (
    ChangeView,
    EmergencyStopView,
    ModeView,
    ParameterView,
    PartView,
    SignalView,
    StepView,
    SystemStateView,
)
from domain.state_and_mode import PartName
from domain.tasks.drive_words import describe_drive_request
from domain.tasks.driving import Driving
from domain.tasks.settings import TaskSettings
from domain.timebase import Instant
from domain.vehicle import VehicleLimits


@dataclass(frozen=True, slots=True)
class SupervisionSettings:
    """What can be set about the core."""

    signals: tuple[SignalSettings, ...] = field(default_factory=default_signals)
    changes: ChangeSettings = field(default_factory=ChangeSettings)
    tasks: TaskSettings = field(default_factory=TaskSettings)
    vehicle: VehicleLimits = field(default_factory=VehicleLimits)


class Supervision:
    """The supervision of one robot."""

    def __init__(self, model: SmhModel, settings: SupervisionSettings, start: Instant) -> None:
        self.model = model
        self._now = start
        self._outbox = Outbox()
        self._inference = ModeInference(model)
        self._admission = ChangeAdmission(model, self._inference.facts)
        self._changes = Changes(self._inference, settings.changes, self._outbox, self._is_stopped)
        self._restoring = Restoring(
            self._inference, self._changes, settings.changes, self._outbox, self._admit
        )
        self._views = PartViews(self._inference, self._changes, self._outbox)
        self._health = StateManager(settings.signals, start)
        self._emergency_stop = EmergencyStop()
        self._health_events = HealthEvents(self._health, self._outbox)
        self.driving = Driving(
            settings.tasks, settings.vehicle, self._health.reasons, self._outbox, start
        )
        self._backend = BackendStatus(available=True)

    # --- time and inputs -------------------------------------------------------------------------

    def wake_at(self) -> Instant | None:
        """Return the next instant at which time alone changes something; None: never."""
        owners = (self._health, self._changes, self.driving)
        return min((at for at in (own.wake_at() for own in owners) if at is not None), default=None)

    def handle(self, given: Input, now: Instant) -> Outputs:
        """Take in one input, after letting pass what was due before it, each at its own time.

        Args:
            given: A fact or a request.
            now: When it arrived; a time before the last one counts as the last one.

        Returns:
            What to do and what was decided; after a refusal, this comes with the next call.

        Raises:
            PilothouseError: The input is refused; nothing was changed by it.
        """
        self._let_pass(max(now, self._now))
        match given:
            case NodeReport():
                self._take_report(given)
            case NodeAnswer():
                self._take_answer(given)
            case Readings():
                self._take_readings(given)
            case ModeRequest() | TransitionRequest() | ParametersRequest():
                self._take_change_request(given)
            case CancelRequest():
                self._begin_input("change.cancel_requested", {"change": given.change}, given.actor)
                self._restoring.cancel(given.change)
                self._changes.cancel(given.change, self._now)
            case EmergencyStopRequest():
                self._take_emergency_stop(given)
            case AcknowledgeRequest():
                self._begin_input("error.acknowledged", {"error": given.error}, given.actor)
                self._publish(self._health.acknowledge(given.error, self._now))
            case VehicleReport():
                self._take_vehicle_report(given)
            case GoalFeedback() | GoalResult():
                self._take_from_navigation(given)
            case TaskRequest() | CancelTaskRequest() | HoldRequest() | ReleaseRequest():
                self._take_drive_request(given)
            case BackendStatus():
                self._take_backend_status(given)
            case WriteRecord():
                self._take_write_record(given)
            case TimePassed():
                pass
        self._settle()
        return self._outbox.take()

    def _let_pass(self, now: Instant) -> None:
        """Handle what became due up to now, in order; what follows later is due then."""
        while (due := self.wake_at()) is not None and due <= now:
            self._now = max(due, self._now)
            self._begin_input("time.passed", {})
            self._publish(self._health.pass_time(self._now))
            self._changes.pass_time(self._now)
            self.driving.pass_time(self._now)
            self._health_events.tell_state(self.driving.status, None)
            self._settle()
        self._now = now

    def _settle(self) -> None:
        """Conclude an input; what is restored because of it has a cause of its own."""
        self._views.settle(self._now)
        while self._restoring.begin_next(self._now):
            self._views.note_actuals(self._outbox.parts)
            self._views.settle(self._now)

    def _begin_input(
        self,
        kind: str,
        data: Mapping[str, object],
        actor: str = "",
        cause: int | None = None,
    ) -> None:
        self._outbox.begin(self._now, kind, data, actor, cause)

    def _take_report(self, report: NodeReport) -> None:
        """Infer first, so that a change is judged by what the report made so.

        Raises:
            InvalidValueError: A parameter has a value of a type that parameters do not have.
            UnknownPartError: The node is not in the model.
        """
        for value in (report.parameters or {}).values():
            value_type(value)
        step = self._changes.step_in_flight(report.node)
        data: dict[str, object] = {"node": report.node}
        if report.state is not None:
            data["state"] = str(report.state)
        if report.mode is not None:
            data["mode"] = report.mode
        if report.parameters is not None:
            data["parameters"] = dict(report.parameters)
        if report.reachable is not None:
            data["reachable"] = report.reachable
        self._begin_input("node.reported", data, cause=step.event if step else None)
        returns = self._restoring.is_return(report)
        changed = self._inference.report(report, self._now)
        self._views.note_reachable(report.node)
        self._views.note_actuals(changed)
        self._changes.report(report, self._now)
        if returns:
            self._restoring.note_return(report.node, step)

    def _take_answer(self, answer: NodeAnswer) -> None:
        step = self._changes.step_in_flight(answer.node)
        awaited = step is not None and step.request == answer.request
        data = {"node": answer.node, "accepted": answer.accepted, "reason": answer.reason}
        self._begin_input("node.answered", data, cause=step.event if step and awaited else None)
        self._changes.answer(answer, self._now)

    def _take_readings(self, readings: Readings) -> None:
        self._health.check(readings, self._now)
        values = {reading.signal: reading.value for reading in readings.items}
        data = {"source": readings.source, "values": values}
        self._begin_input("signal.read", data, readings.actor)
        self._publish(self._health.receive(readings, self._now))

    def _take_change_request(self, request: ChangeRequest) -> None:
        part = check_request(self.model, self._inference.facts, request)
        goal = self._admit(request)
        data = {"part": part, **describe_request(request)}
        self._begin_input("change.requested", data, request.actor)
        self._outbox.change = self._changes.begin(part, request, goal, self._now)
        self._restoring.forget(goal.targets)
        self._views.note_actuals(self._outbox.parts)

    def _admit(self, request: ChangeRequest) -> ChangeGoal:
        if not self._backend.available:
            raise BackendUnavailableError(self._backend.reason)
        return self._admission.admit(request, self._estop())

    def _take_emergency_stop(self, request: EmergencyStopRequest) -> None:
        latch, now = self._emergency_stop, self._now
        act = latch.engage if request.engaged else latch.release
        if act(request.actor, request.reason, now):
            kind = "emergency_stop.engaged" if request.engaged else "emergency_stop.released"
            self._begin_input(kind, {"reason": request.reason}, request.actor)
            self._outbox.record_input()
            changes = self._health.set_emergency_stop(request.engaged, now)
            self._publish(changes)

    def _take_backend_status(self, status: BackendStatus) -> None:
        if status.available is not self._backend.available:
            kind = "backend.available" if status.available else "backend.unavailable"
            self._begin_input(kind, {"reason": status.reason})
            self._outbox.record_input()
        self._backend = status

    def _take_write_record(self, record: WriteRecord) -> None:
        data = {
            "method": record.method,
            "path": record.path,
            "status": record.status,
            "address": record.address,
        }
        self._begin_input("audit.write", data, record.actor)
        self._outbox.record_input()

    def _take_vehicle_report(self, report: VehicleReport) -> None:
        self.driving.check(report)
        pose = report.state.pose
        data = {"x_m": pose.x_m, "y_m": pose.y_m, "speed_mps": report.state.speed_mps}
        self._begin_input("vehicle.reported", data)
        self._drive(report)
        if self.driving.stands and self._emergency_stop.note_standstill(self._now):
            self._outbox.emit("emergency_stop.standstill", {})

    def _take_from_navigation(self, given: GoalFeedback | GoalResult) -> None:
        data: dict[str, object] = {"goal": given.goal}
        if isinstance(given, GoalResult):
            data |= {"succeeded": given.succeeded, "reason": given.reason}
        kind = "goal.ended" if isinstance(given, GoalResult) else "goal.feedback"
        self._begin_input(kind, data)
        self._drive(given)

    def _take_drive_request(self, request: DriveRequest) -> None:
        self.driving.check(request)
        kind, data = describe_drive_request(request)
        self._begin_input(kind, data, request.actor)
        self._drive(request)

    def _drive(self, given: DriveRequest | VehicleReport | GoalFeedback | GoalResult) -> None:
        before = self.driving.status
        self.driving.take(given, self._now)
        if self.driving.status is not before:
            self._health_events.tell_state(self.driving.status, None)

    def _publish(self, changes: HealthChanges) -> None:
        """Tell what was decided; the robot is made safe before its state is told."""
        cause = self._health_events.publish(changes)
        if changes.state_changed:
            self.driving.follow_errors(self._health.reasons, self._now, cause)
            self._health_events.tell_state(self.driving.status, cause)

    def _is_stopped(self) -> bool:
        return "ESTOP" in self._health.errors

    def _estop(self) -> tuple[Blocker, ...]:
        """Return why ESTOP is on; empty when it is not."""
        if not self._is_stopped():
            return ()
        return tuple(r for r in self.system_state().reasons if r.code == "ESTOP")

    # --- what can be seen ------------------------------------------------------------------------

    def part(self, name: PartName) -> PartView:
        """Return one part that the model has."""
        return self._views.get(name)

    def parts(self) -> Mapping[PartName, PartView]:
        """Return all parts, systems first, in the order of the model file."""
        return self._views.all()

    def modes(self, part: PartName) -> tuple[ModeView, ...]:
        """Return the modes of a part, and what stands against entering each of them now."""
        estop = self._estop()
        views = []
        for mode in self.model.modes_of(part):
            blockers = self._admission.blockers(ModeRequest(part, mode), estop)
            views.append(ModeView(mode, not blockers, blockers))
        return tuple(views)

    def parameters(self, node: PartName) -> tuple[ParameterView, ...]:
        """Return the parameters of a node."""
        return self._views.parameters(node)

    def available_transitions(self, part: PartName) -> tuple[Transition, ...]:
        """Return the transitions that would be accepted now and lead somewhere else."""
        return self._admission.available_transitions(part, self._estop())

    def plan(self, request: ChangeRequest) -> tuple[StepView, ...]:
        """Return the steps that a request would take now; nothing is changed.

        Raises:
            PilothouseError: The request would be refused.
        """
        check_request(self.model, self._inference.facts, request)
        goal = self._admit(request)
        steps = []
        for node, node_goal in goal.nodes.items():
            facts = self._inference.facts[node]
            unknown = facts.known_state is LifecycleState.UNKNOWN
            actions = presumed_steps(node_goal) if unknown else next_steps(facts, node_goal)
            steps += [Step(ChangeId(""), node, action).view() for action in actions or ()]
        return tuple(steps)

    def change(self, identity: str) -> ChangeView:
        """Return a change.

        Raises:
            UnknownChangeError: There is none of that id, or it is forgotten.
        """
        return self._changes.get(identity).view()

    def changes(
        self, limit: int | None = None, part: PartName | None = None
    ) -> tuple[ChangeView, ...]:
        """Return the changes that are kept, the newest first.

        Args:
            limit: At most so many.
            part: Only those that were asked of this part.
        """
        kept = (c for c in self._changes.all() if part is None or c.part == part)
        return tuple(change.view() for change in islice(kept, limit))

    def signal(self, name: str) -> SignalView:
        """Return one signal.

        Raises:
            UnknownSignalError: It is not declared.
        """
        return self._health.signal(name)

    def signals(self) -> Mapping[str, SignalView]:
        """Return all signals."""
        return self._health.signals()

    def system_state(self) -> SystemStateView:
        """Return the state of the robot."""
        return self._health.system_state(self.driving.status)

    def emergency_stop(self) -> EmergencyStopView:
        """Return the emergency stop."""
        return self._emergency_stop.view()
