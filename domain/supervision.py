"""The core: one input at a time in; commands and events out. It makes all decisions.

It does no I/O and has no clock. The same inputs at the same times give the same outputs, in the
live service, in a simulation and in a test.

Its concerns make the decisions; this module keeps their order.
"""

from collections.abc import Iterable, Iterator, Mapping

from domain.analysis.fault_trees import ErrorGraph, error_graph
from domain.audit import Audit
from domain.changes.changing import Changing
from domain.changes.guards import Guards
from domain.commands import TellStops
from domain.computers import ComputerName
from domain.concern import Concern, overrides, settle, takers_of
from domain.conditions.watched import WatchedConditions
from domain.devices.device_view import DeviceView
from domain.devices.devices import Devices
from domain.devices.lead import Lead
from domain.devices.lead_view import LeadView
from domain.devices.settings import LeadSettings
from domain.events.service import TimeWasDue
from domain.fact_changes import FactChanges
from domain.findings import Blocker
from domain.graph_faults import GraphFaults
from domain.graph_terms import GraphFault
from domain.health.announcing import Announcing
from domain.health.built_in_errors import LOST, UNREACHABLE
from domain.health.checkpoint_errors import CheckpointErrors
from domain.health.emergency_stop import EmergencyStop
from domain.health.error_causes import ErrorCauses
from domain.health.health import Health
from domain.health.mode_limits import ModeLimits
from domain.health.part_errors import PartErrors
from domain.health.propagation import Propagation
from domain.health.reported_errors import ReportedErrors
from domain.inputs import ChangeRequest, Input, TimePassed, WriteRecord
from domain.lifecycle import Transition
from domain.loosening import may_loosen
from domain.outbox import Outbox, Outputs
from domain.parts.parts import Parts
from domain.parts.system_model import SmhModel
from domain.processes.processes import Processes
from domain.reactions.displacing import Displacing
from domain.reactions.fallbacks import Fallbacks
from domain.reactions.reaction import Reaction, reactions_of
from domain.reactions.reaction_view import ReactionView
from domain.reactions.reactions import Reactions
from domain.reactions.rules import Rules
from domain.reactions.settings import RuleSettings
from domain.restart import Restart
from domain.robot_facts import RobotFacts
from domain.robot_state import RobotState
from domain.snapshot import (
    ChangeView,
    EmergencyStopView,
    ErrorKey,
    ErrorView,
    ModeView,
    MonitorView,
    ParameterView,
    PartView,
    PlanView,
    SignalView,
    SystemStateView,
)
from domain.stalls import Stalls
from domain.state_and_mode import ModeName, PartName
from domain.storage import Storage
from domain.supervision_settings import SupervisionSettings
from domain.tasks.driving import Driving
from domain.tasks.standstill import Standstill
from domain.timebase import Instant

_SPARE_ROUNDS = 100
"""Rounds of settling besides one per part; each round restores one node at most."""


__all__ = ["Supervision", "SupervisionSettings"]


class Supervision:
    """The supervision of one robot: its concerns, and the order in which they act."""

    def __init__(self, model: SmhModel, settings: SupervisionSettings, start: Instant) -> None:
        """Begin with all nodes unknown and no readings.

        Args:
            model: Systems and nodes of the robot.
            settings: Settings of signals, changes, tasks and vehicle.
            start: The current time; the times of silent signals count from here.
        """
        self.model = model
        self._now = start
        outbox = self._outbox = Outbox()
        parts = self._parts = Parts(model, outbox, settings.device_of)
        checkpoints, processes = settings.checkpoints, settings.processes
        causes = ErrorCauses(model, checkpoints, settings.nodes_of_devices, processes)
        health = self._health = Health(settings.signals, outbox, start, causes)
        stop = self._emergency_stop = EmergencyStop(health, outbox, settings.peers)
        self.driving = Driving(
            settings.tasks,
            settings.vehicle,
            health,
            stop,
            outbox,
            start,
            has_vehicle=settings.lead is None,
        )
        storage = Storage(outbox)
        self._graph_faults = GraphFaults(outbox)
        self._robot_state = RobotState(health, self.driving, storage, outbox)
        # What is lost with a device follows from that from the start.
        self._devices = self._devices_by(settings, start)
        errors = self._part_errors = PartErrors(parts, health.error_list, outbox, start)
        self.processes = Processes(processes, model.nodes, errors, outbox)
        """The processes of nodes; read only."""
        self.facts = RobotFacts(parts, health, self.driving, errors.reason)
        """What conditions are evaluated over."""
        self.conditions = WatchedConditions(self.facts)
        """The conditions of the model, kept up to date; read only."""
        guards = Guards(model, self.conditions, start)
        reactions = reactions_of(model, self.conditions, start, settings.reactions_of_devices)
        self._changing = Changing(parts, health, errors, settings.changes, outbox, guards)
        displacing = Displacing(parts, self._changing, outbox)
        self._reactions = self._reactions_by(displacing, reactions, guards, start)
        self._lead = self._lead_by(settings.lead, start)
        is_device = self._lead is not None
        # A device leaves degrading and climbing back to its supervisor.
        displacers = () if is_device else self._displacers(guards, settings.rules, displacing)
        self._concerns = self._in_order(settings, displacers, storage, start)
        self._arrange()

    def _in_order(
        self,
        settings: SupervisionSettings,
        displacers: tuple[Concern, ...],
        storage: Storage,
        start: Instant,
    ) -> tuple[Concern, ...]:
        """Return the concerns in the order in which they act."""
        # Driving stops the vehicle before the state is published and changes continue.
        return (
            Restart(self._outbox),
            self._parts,
            self._health,
            self._emergency_stop,
            self._devices,
            ModeLimits(settings.signals, self._parts, self._health, self._outbox),
            # It rejects what is the supervisor's to ask, before anything comes of it.
            *(() if self._lead is None else (self._lead,)),
            self.driving,
            Standstill(self.driving, self._emergency_stop, self._outbox),
            storage,
            self._graph_faults,
            self._robot_state,
            self._part_errors,
            *self._after_part_errors(settings, start),
            self._changing,
            # What sets targets in force, the stronger first.
            self._reactions,
            *displacers,
            Audit(self._outbox),
            Stalls(self._outbox),
        )

    def _after_part_errors(
        self, settings: SupervisionSettings, start: Instant
    ) -> tuple[Concern, ...]:
        """Return what else raises errors of parts, what conditions then say, and who is told."""
        parts, health, errors, outbox = self._parts, self._health, self._part_errors, self._outbox
        announcing = Announcing(health, errors, self.conditions, outbox, start)
        unheard = {UNREACHABLE: errors.unheard, LOST: self._devices.unheard}
        propagation = Propagation(health.error_list, self.conditions, unheard, outbox, start)
        return (
            ReportedErrors(self.model, health.error_list, outbox),
            CheckpointErrors(settings.checkpoints, parts, health, errors, outbox),
            self.processes,
            # It evaluates all conditions, and so comes last of those that watch some.
            FactChanges(self.conditions, parts, self.driving, outbox),
            propagation,
            announcing,
        )

    def _reactions_by(
        self, displacing: Displacing, reactions: list[Reaction], guards: Guards, start: Instant
    ) -> Reactions:
        return Reactions(
            reactions,
            self._parts,
            self._changing,
            self._health,
            self._emergency_stop,
            self.driving,
            guards,
            displacing,
            self._outbox,
            start,
        )

    def _devices_by(self, settings: SupervisionSettings, start: Instant) -> Devices:
        within, errors = settings.devices_heard_within, self._health.error_list
        parts, stop = self._parts, self._emergency_stop
        return Devices(settings.devices, within, parts, errors, stop, self._outbox, start)

    def _lead_by(self, settings: LeadSettings | None, start: Instant) -> Lead | None:
        if settings is None:
            return None
        parts, changing, reactions = self._parts, self._changing, self._reactions
        return Lead(settings, parts, changing, reactions, self._health, self._outbox, start)

    def _displacers(
        self, guards: Guards, rules: RuleSettings, displacing: Displacing
    ) -> tuple[Concern, Concern]:
        parts, changing, health, outbox = self._parts, self._changing, self._health, self._outbox
        errors = self._part_errors
        return (
            Fallbacks(parts, changing, health, errors, guards, displacing, outbox),
            Rules(parts, changing, health, rules, displacing, outbox),
        )

    def _arrange(self) -> None:
        """Note which concerns have to be asked when; most have nothing to do most of the time."""
        self._health.error_list.mark_start()
        self._outbox.errors.clear()  # What is on from the start is no change.
        self._takers = {TimePassed: (), **takers_of(self._concerns)}
        self._clocked = [c for c in self._concerns if overrides(c, "wake_at")]
        self._settling = [c for c in self._concerns if overrides(c, "settle")]
        self._portioned = [c for c in self._concerns if overrides(c, "go_on")]
        self._has_more = False
        self._max_rounds = _SPARE_ROUNDS + len(self.model.parts)
        self._wake_at = self._next_wake()
        """Cached: it is read several times per input, and only inputs and time change it."""

    @property
    def next_event(self) -> int:
        """Return the id that the next event gets."""
        return self._outbox.next_event

    # --- time and inputs -------------------------------------------------------------------------

    def wake_at(self) -> Instant | None:
        """Return the next instant at which time alone changes something; None: never.

        That is the time of the last input as long as work is left for later turns; each
        `TimePassed` does a portion of it.
        """
        return self._now if self._has_more else self._wake_at

    def handle(self, given: Input, now: Instant) -> Outputs:
        """Handle one input, after everything that was due before it, each at its own time.

        Args:
            given: A fact or a request.
            now: When it arrived; a time before the last one counts as the last one.

        Returns:
            Commands, events and changed views; after a rejection, the next call returns them.

        Raises:
            PilothouseError: The input is rejected; it changed nothing.
        """
        self._let_pass(max(now, self._now))
        return self._take(given)

    def take_in(self, given: Input, now: Instant) -> Outputs:
        """Handle one input that is late by our own fault, before what was due before it.

        The next `handle` judges what is due then: an age that the input ended never was too high.

        Args:
            given: A fact or a request.
            now: The current time; when the input arrived is not known.

        Returns:
            As `handle`.

        Raises:
            PilothouseError: The input is rejected; it changed nothing.
        """
        self._now = max(now, self._now)
        with self._health.late():
            return self._take(given)

    def _take(self, given: Input) -> Outputs:
        for take in self._takers[type(given)]:
            take(given, self._now)
        if self._has_more and isinstance(given, TimePassed):
            self._go_on()
        # Nothing follows from a record, and all was settled before it.
        if not isinstance(given, WriteRecord):
            self._settle()
        return self._outbox.take()

    def _let_pass(self, now: Instant) -> None:
        """Handle all deadlines up to `now` in order, including those that follow from them."""
        while (due := self._wake_at) is not None and due <= now:
            self._now = max(due, self._now)
            self._outbox.begin(self._now, TimeWasDue())
            for concern in self._clocked:
                concern.pass_time(self._now)
            self._settle()
        self._now = now

    def _go_on(self) -> None:
        """Do one portion: what an earlier concern left comes before what follows from it."""
        for concern in self._portioned:
            if concern.has_more:
                concern.go_on(self._now)
                return

    def _settle(self) -> None:
        settle(self._settling, self._now, self._max_rounds)
        self._wake_at = self._next_wake()
        self._has_more = False
        for concern in self._portioned:
            if concern.has_more:
                self._has_more = True

    def _next_wake(self) -> Instant | None:
        due = None
        for concern in self._clocked:
            at = concern.wake_at()
            if at is not None and (due is None or at < due):
                due = at
        return due

    # --- what can be seen ------------------------------------------------------------------------

    def part(self, name: PartName) -> PartView:
        """Return one part; the model must have it."""
        return self._parts.view(name)

    def parts(self) -> Mapping[PartName, PartView]:
        """Return all parts, systems first, in the order of the model file."""
        return self._parts.views()

    def modes(self, part: PartName) -> tuple[ModeView, ...]:
        """Return the modes of a part, with the blockers of each."""
        return tuple(self.mode(part, mode) for mode in self.model.modes_of(part))

    def mode(self, part: PartName, mode: ModeName) -> ModeView:
        """Return a mode of a part, with its blockers."""
        view = self._changing.mode(part, mode)
        return view if self._lead is None else self._lead.restricted(part, view)

    def why(self, part: PartName) -> tuple[Blocker, ...]:
        """Return why a part is not where it should be, the reasons nearest to it first."""
        return self._changing.why(part)

    def parameters(self, node: PartName) -> tuple[ParameterView, ...]:
        """Return the parameters of a node."""
        return self._parts.parameters(node)

    def available_transitions(self, part: PartName) -> tuple[Transition, ...]:
        """Return the transitions that would be accepted now and change something."""
        available = self._changing.available_transitions(part)
        return available if self._lead is None else self._lead.available(available)

    def plan(self, request: ChangeRequest) -> PlanView:
        """Return what a request would do now, without starting it.

        Raises:
            PilothouseError: The request would be rejected.
        """
        if self._lead is not None:
            self._lead.check(request)
        return self._changing.plan(request)

    def change(self, identity: str) -> ChangeView:
        """Return a change.

        Raises:
            UnknownChangeError: The id is unknown, or the change is no longer kept.
        """
        return self._changing.change(identity)

    def changes(
        self, limit: int | None = None, part: PartName | None = None
    ) -> tuple[ChangeView, ...]:
        """Return the changes that are kept, the newest first.

        Args:
            limit: Largest number of changes; None: all.
            part: Only changes that were requested of this part.
        """
        return self._changing.changes(limit, part)

    def signal(self, name: str) -> SignalView:
        """Return one signal.

        Raises:
            UnknownSignalError: It is not declared.
        """
        return self._health.signal(name)

    def signals_named(self, names: Iterable[str]) -> dict[str, SignalView]:
        """Return several signals, as `signal` does, in the order of the names."""
        return self._health.signals_named(names)

    def signals(self) -> Mapping[str, SignalView]:
        """Return all signals."""
        return self._health.signals()

    def graph_faults(self) -> tuple[GraphFault, ...]:
        """Return what is wrong in the ROS graph, in the order in which it was found."""
        return tuple(self._graph_faults.faults.values())

    def monitors(self) -> tuple[MonitorView, ...]:
        """Return the monitors, as of the last input."""
        return tuple(self._health.monitors(self._now))

    def error(self, key: ErrorKey) -> ErrorView:
        """Return one error, as `Outputs.errors` names it."""
        return self._health.error_list.view(key)

    def errors(self) -> Iterator[ErrorView]:
        """Yield all errors: the robot's own, those of devices, then those of the parts.

        Both are in the order of their file.
        """
        yield from self._health.error_views()
        for device in self._health.error_list.causes.devices:
            yield from self.errors_of(device)
        for part in self.model.parts:
            yield from self.errors_of(part)

    def errors_of(self, part: PartName) -> Iterator[ErrorView]:
        """Yield the errors of one part, those that signals raise last; or those of a device.

        There must be such a part or device.
        """
        yield from self._part_errors.views_of(part)
        yield from self._health.error_views(part)

    def reaction(self, key: str) -> ReactionView:
        """Return one reaction, as `Outputs.reactions` names it."""
        return self._reactions.view_of(key)

    def reaction_of(self, part: PartName, name: str) -> ReactionView:
        """Return one reaction of a part.

        Raises:
            UnknownReactionError: The part has no reaction of this name.
        """
        return self._reactions.view(part, name)

    def reactions(self) -> Mapping[str, ReactionView]:
        """Return all reactions by their names, in the order of the file."""
        return {view.name: view for view in self._reactions.views()}

    def open_errors(self) -> Mapping[str, ErrorView]:
        """Return the errors that are not normal, by their names."""
        return self._health.error_list.open_ones()

    def error_graph(self) -> ErrorGraph:
        """Return the critical and fatal errors, and the errors that they follow from."""
        return error_graph(self.model, self._health.severities())

    @property
    def parts_with_errors(self) -> Mapping[str, int]:
        """Return by error how many parts have it now."""
        return self._health.error_list.parts_with

    def system_state(self) -> SystemStateView:
        """Return the state of the robot."""
        return self._robot_state.view()

    def may_loosen(self, given: Input) -> bool:
        """Tell whether a request may start or loosen something as things are now."""
        stopped, holds = self.emergency_stop().engaged, self.driving.holds
        return may_loosen(given, is_stopped=stopped, holds=holds)

    def check_said_here(self, given: Input) -> None:
        """Check that an input that did not come from a device is not a device's to say.

        Raises:
            ActsElsewhereError: A device reads the signal, or owns the part with the error.
        """
        self._devices.owned_facts.check_said_here(given)

    def lead(self) -> LeadView | None:
        """Return whose word counts at this device; None: this computer follows nobody."""
        return None if self._lead is None else self._lead.view()

    def devices(self) -> Mapping[ComputerName, DeviceView]:
        """Return the devices of the robot by name; empty: it has but one computer."""
        return self._devices.views()

    def emergency_stop(self) -> EmergencyStopView:
        """Return the emergency stop; the same object until it changes."""
        return self._emergency_stop.view()

    def stops_to_tell(self) -> TellStops:
        """Return what other computers of the robot are to know of the stops of this one."""
        return self._emergency_stop.told()
