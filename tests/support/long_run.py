"""A robot that lives for days, over restarts of its service; what must hold is looked at always."""

from random import Random

from domain.commands import AskParameters, AskTransition, Drive, NodeCommand
from domain.inputs import Input, Restored
from domain.kept import (
    Kept,
    KeptChange,
    KeptEmergencyStop,
    KeptError,
    KeptHold,
    KeptProgress,
    KeptTarget,
    KeptTask,
)
from domain.lifecycle import Transition
from domain.outbox import NOTHING, Outputs
from domain.snapshot import ChangeStatus, SystemState, TaskPhase, TaskStatus
from domain.supervision import SupervisionSettings
from domain.tasks.holds import RESERVED, RESTART_HOLD
from domain.timebase import seconds
from service.codec.codec import KEPT
from service.files.robot_file import read_robot_file
from service.storage.id_blocks import CHANGE, EVENT, TASK, IdBlocks
from tests.support.core_robot import CoreRobot
from tests.support.live_robot import make_onboard
from tests.support.models import nested_model

ROBOT = (
    "nodes: {drive_base: {on_return: restore}}\n"
    "changes: {transition_deadline_s: 4}\n"
    "signals: {stale_after_s: 60, temperature: {recovery: acknowledge}}\n"
)
_SILENCE_S = 2.0
"""After a restart nobody asks for anything."""


class LongRun(CoreRobot):
    """A robot whose service is killed or ended, and started again, any number of times.

    Args:
        seed: Tells one run from another.
    """

    def __init__(self, seed: int) -> None:
        self.random = Random(seed)
        self.kept: dict[tuple[type[Kept], str], bytes] = {}
        """What is on disk."""
        self.boot = 1
        self.inputs = 0
        self.last_event = 0
        self._ids = IdBlocks({})
        self._begun: set[str] = set()
        """Changes and tasks that were told, by id."""
        self._is_silent = False
        model = nested_model()
        file = read_robot_file(ROBOT, model)
        self._settings = SupervisionSettings(
            file.to_signal_settings(), file.to_change_settings(), file.to_task_settings()
        )
        super().__init__(model, self._settings)

    def give(self, given: Input) -> Outputs:
        """Hand one input to the core, and look at all that follows."""
        self.inputs += 1
        before = self._stopped, self._has_estop
        outputs = self.onboard.handle(given, self.now)
        if outputs is NOTHING:
            return outputs
        self._look_at(given, outputs, *before)
        for command in outputs.commands:
            assert isinstance(command, NodeCommand | Drive), "goals stay on board"
            if self._is_silent:
                assert not isinstance(command, AskTransition | AskParameters), command
                assert not isinstance(command, Drive) or not command.command.speed_mps, command
            self.robot.handle(command, self.now)
        self._ids.see(outputs)
        for item in outputs.kept:
            if item.value is None:
                self.kept.pop((item.kind, item.name), None)
            else:
                self.kept[item.kind, item.name] = KEPT.encode(item.value)
        if outputs.events or outputs.kept:
            self._look()
        return outputs

    def restart(self, down_s: float, *, is_killed: bool) -> None:
        """End the service and start it again; the robot does meanwhile what it does.

        Args:
            down_s: How long it is down.
            is_killed: Whether it could not say which ids it used.
        """
        before = self.shown()
        self.now += seconds(down_s)
        self.robot.advance(self.now)
        self.boot += 1
        first = self._ids.exact()
        if is_killed:
            first = {kind: id_ + 1_000 for kind, id_ in first.items()}
        self._ids = IdBlocks(first)
        kept = tuple(KEPT.decode(text) for text in self.kept.values())
        self.onboard = make_onboard(self.model, self.now, self._settings)
        self.core = self.onboard.core
        self._is_silent = True
        self.give(Restored(kept, self.boot, first[EVENT], first[CHANGE], first[TASK]))
        assert self.shown() == before
        self.advance(_SILENCE_S)
        self._is_silent = False

    # --- what must hold ---------------------------------------------------------------------------

    def shown(self) -> tuple[object, ...]:
        """Return what an operator sees of that which a restart must not change."""
        driving = self.core.driving
        stop = self.core.emergency_stop()
        return (
            {owner: hold for owner, hold in driving.holds.items() if _is_set(owner)},
            (stop.engaged, stop.by, stop.reason, stop.since),
            [(task.id, task.status) for task in driving.tasks() if task.ended_at is not None],
            [task.id for task in driving.tasks()],
            [self.core.part(part).target for part in self.model.parts],
            {name for name, view in self.core.signals().items() if view.needs_acknowledgement},
        )

    @property
    def _stopped(self) -> bool:
        return bool(self.core.driving.holds)

    @property
    def _has_estop(self) -> bool:
        return "ESTOP" in self.core.system_state().errors

    def _look_at(self, given: Input, outputs: Outputs, was_stopped: bool, had_estop: bool) -> None:
        """Check commands and events of one input; what it ends or begins may go either way."""
        for command in outputs.commands:
            if isinstance(command, Drive) and was_stopped and self._stopped:
                assert command.command.speed_mps == 0.0, (given, command)
            if isinstance(command, AskTransition) and had_estop and self._has_estop:
                assert command.transition is not Transition.ACTIVATE, (given, command)
        for event in outputs.events:
            assert event.id > self.last_event, event
            assert event.cause is None or event.cause < event.id, event
            self.last_event = event.id
        for item in outputs.kept:
            if item.kind in (KeptChange, KeptTask) and item.value is not None:
                assert item.name not in self._begun, f"{item.name} is used twice"
                self._begun.add(item.name)

    def _look(self) -> None:
        """Check what is seen at this moment, and that as much is on disk."""
        core, driving = self.core, self.core.driving
        state, stop = core.system_state(), core.emergency_stop()
        assert (state.error_code != 0) is (state.state is SystemState.ERROR), state
        assert bool(state.errors) is (state.error_code != 0), state
        assert set(state.errors) <= {reason.code for reason in state.reasons}, state
        assert not stop.engaged or "ESTOP" in state.errors, state
        if self._stopped:
            assert driving.vehicle.command.speed_mps == 0.0, driving.vehicle
        task = driving.current_task
        has_task = task is not None and not state.error_code
        assert (state.state is SystemState.RUNNING) is has_task, (state, task)
        assert (task is not None and task.status is TaskPhase.RUNNING) is (
            state.task_status is TaskStatus.RUNNING_TASK
        ), (state, task)
        assert not self._stopped or state.task_status is not TaskStatus.RUNNING_TASK, state

        assert self._names(KeptHold) == set(filter(_is_set, driving.holds))
        assert self._names(KeptTask) == {task.id for task in driving.tasks()}
        assert self._names(KeptProgress) <= self._names(KeptTask)
        assert self._names(KeptChange) == {
            change.id for change in core.changes() if change.status is ChangeStatus.RUNNING
        }
        assert len(self._names(KeptTarget)) <= len(self.model.parts)
        waiting = [view for view in core.signals().values() if view.needs_acknowledgement]
        assert len(self._names(KeptError)) == len(waiting)
        kept_stop = self.kept.get((KeptEmergencyStop, ""))
        if kept_stop is not None or stop.engaged:
            assert kept_stop is not None
            assert KEPT.decode(kept_stop).engaged is stop.engaged  # type: ignore[union-attr]

    def _names(self, kind: type[Kept]) -> set[str]:
        return {name for kept, name in self.kept if kept is kind}


def _is_set(owner: str) -> bool:
    """Tell whether a hold was set by somebody, and not by Pilothouse itself."""
    return owner not in RESERVED and owner != RESTART_HOLD
