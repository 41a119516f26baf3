"""A value or two of each kind of event: with all fields, and with every default."""

from collections.abc import Mapping

from domain.computers import SUPERVISOR, ComputerName, StopId
from domain.events.announcing import ErrorChattering, ErrorShelved, ErrorUnshelved
from domain.events.changes import (
    BackendAvailable,
    BackendUnavailable,
    ChangeCanceled,
    ChangeCancelRequested,
    ChangeFailed,
    ChangeRequested,
    ChangeSucceeded,
    ChangeSuperseded,
    ChangeTimedOut,
    ChangeWaiting,
    NodeAnswered,
    NodeNotRestored,
    NodeRestoring,
    StepEnded,
    StepStarted,
)
from domain.events.driving import (
    DriveAvailable,
    DriveUnavailable,
    GoalEnded,
    GoalProgressed,
    HoldReleased,
    HoldReleaseRequested,
    HoldRequested,
    HoldSet,
    NavigationAvailable,
    NavigationUnavailable,
    TaskAborted,
    TaskCanceled,
    TaskCancelRequested,
    TaskPaused,
    TaskPausing,
    TaskRequested,
    TaskResumed,
    TaskServed,
    TaskStarted,
    TaskSucceeded,
    VehicleReported,
    VehicleStandstillUnknown,
    VehicleStillMoving,
    VehicleStopped,
)
from domain.events.health import (
    EmergencyStopEngaged,
    EmergencyStopReleased,
    EmergencyStopStandstill,
    ErrorAcknowledged,
    ErrorReported,
    PeerStopEngaged,
    PeerStopReleased,
    PropagationNotSeen,
    SignalLimitsChanged,
    SignalNotRead,
    SignalPending,
    SignalRead,
    SignalSettled,
    SignalSkewed,
    StopReleaseAsked,
    SystemStateChanged,
)
from domain.events.lead import (
    DeviceActsAlone,
    DeviceFollowsAgain,
    DeviceTargetLeft,
    OrderRefused,
    OrderTaken,
    SupervisorConnected,
    SupervisorLate,
    SupervisorLost,
)
from domain.events.parts import (
    CheckpointReached,
    DeviationBegan,
    DeviationEnded,
    NodeReachable,
    NodeReported,
    NodeUnreachable,
    PartActualChanged,
)
from domain.events.reactions import (
    ReactionAcknowledged,
    ReactionActing,
    ReactionArmRequested,
    ReactionEnded,
    ReactionExhausted,
    ReactionOverruled,
    ReactionReported,
    ReactionWouldAct,
)
from domain.events.service import (
    GraphFaultEnded,
    GraphFaultFound,
    NotRestored,
    ServiceRestored,
    ServiceStalled,
    StorageDegraded,
    StorageRecovered,
    TimeWasDue,
    WriteAnswered,
)
from domain.events.targets import (
    DisplacementBegan,
    DisplacementEnded,
    DisplacementStays,
    RuleNotApplied,
)
from domain.identifiers import ChangeId, GoalId, TaskId
from domain.lifecycle import LifecycleState, Transition
from domain.reaction_terms import Action, Arm, ReactionState
from domain.snapshot import Because, StepStatus, SystemState
from domain.state_and_mode import ModeName, PartName, StateAndMode
from tests.support.record_samples.device_events import DEVICE_EVENTS
from tests.support.record_samples.error_events import ERROR_EVENTS
from tests.support.record_samples.pieces import PARAMETERS

EVENTS: Mapping[str, tuple[object, ...]] = {
    "audit.write": (WriteAnswered(method="POST", path="/tasks", status=201, address="10.0.0.7"),),
    "backend.available": (BackendAvailable(reason='Größe ≤ 3 — "gripper\\jam"'),),
    "backend.unavailable": (BackendUnavailable(reason='Größe ≤ 3 — "gripper\\jam"'),),
    "change.cancel_requested": (ChangeCancelRequested(change="17"),),
    "change.canceled": (
        ChangeCanceled(
            change=ChangeId("17"), part=PartName("arm"), reason='Größe ≤ 3 — "gripper\\jam"'
        ),
    ),
    "change.waiting": (
        ChangeWaiting(
            change=ChangeId("17"), part=PartName("arm"), reason='Größe ≤ 3 — "gripper\\jam"'
        ),
    ),
    "change.failed": (
        ChangeFailed(
            change=ChangeId("17"), part=PartName("arm"), reason='Größe ≤ 3 — "gripper\\jam"'
        ),
    ),
    "change.requested": (
        ChangeRequested(
            part=PartName("arm"), mode="FAST", transition=Transition.ACTIVATE, parameters=PARAMETERS
        ),
        ChangeRequested(part=PartName("arm"), mode=None, transition=None, parameters=None),
    ),
    "change.step_ended": (
        StepEnded(
            change=ChangeId("17"),
            node=PartName("left/arm"),
            action="activate",
            status=StepStatus.SUCCEEDED,
            error="LOW_BATTERY",
        ),
    ),
    "change.step_started": (
        StepStarted(change=ChangeId("17"), node=PartName("left/arm"), action="activate"),
    ),
    "change.succeeded": (
        ChangeSucceeded(
            change=ChangeId("17"), part=PartName("arm"), reason='Größe ≤ 3 — "gripper\\jam"'
        ),
    ),
    "change.superseded": (
        ChangeSuperseded(
            change=ChangeId("17"), part=PartName("arm"), reason='Größe ≤ 3 — "gripper\\jam"'
        ),
    ),
    "change.timed_out": (
        ChangeTimedOut(
            change=ChangeId("17"), part=PartName("arm"), reason='Größe ≤ 3 — "gripper\\jam"'
        ),
    ),
    "drive.available": (DriveAvailable(),),
    "drive.unavailable": (DriveUnavailable(reason='Größe ≤ 3 — "gripper\\jam"'),),
    "navigation.available": (NavigationAvailable(),),
    "navigation.unavailable": (NavigationUnavailable(reason="the controller gave no feedback"),),
    "emergency_stop.engaged": (EmergencyStopEngaged(reason='Größe ≤ 3 — "gripper\\jam"'),),
    "emergency_stop.peer_engaged": (
        PeerStopEngaged(
            computer=ComputerName("arm"),
            stop=StopId("0f0f-3"),
            by="ada",
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
    ),
    "emergency_stop.peer_released": (
        PeerStopReleased(computer=ComputerName("arm"), stop=StopId("0f0f-3")),
    ),
    "emergency_stop.release_asked": (
        StopReleaseAsked(computer=ComputerName("arm"), stops=(StopId("0f0f-3"),)),
    ),
    "emergency_stop.released": (
        EmergencyStopReleased(reason='Größe ≤ 3 — "gripper\\jam"'),
        EmergencyStopReleased(
            reason="the track is clear", still_engaged_at=(ComputerName("arm"), SUPERVISOR)
        ),
    ),
    "emergency_stop.standstill": (EmergencyStopStandstill(),),
    "device.acts_alone": (DeviceActsAlone(device="arm", does='Größe ≤ 3 — "gripper\\jam"'),),
    "device.follows_again": (DeviceFollowsAgain(device="arm"),),
    "device.target_left": (
        DeviceTargetLeft(
            device="arm",
            part=PartName("left/arm"),
            target=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("SLOW")),
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
    ),
    "reaction.reported": (
        ReactionReported(part=PartName("left/arm"), reaction="LIMP", state=ReactionState.EXHAUSTED),
    ),
    "order.refused": (
        OrderRefused(
            node=PartName("left/arm"), action="activate", reason='Größe ≤ 3 — "gripper\\jam"'
        ),
    ),
    "order.taken": (OrderTaken(node=PartName("left/arm"), action="set_parameters"),),
    "supervisor.connected": (SupervisorConnected(device="arm"),),
    "supervisor.late": (SupervisorLate(device="arm", reason='Größe ≤ 3 — "gripper\\jam"'),),
    "supervisor.lost": (SupervisorLost(device="arm", reason='Größe ≤ 3 — "gripper\\jam"'),),
    "error.acknowledged": (
        ErrorAcknowledged(error="LOW_BATTERY"),
        ErrorAcknowledged(error="DEVIATES", part=PartName("arm")),
    ),
    "error.chattering": (
        ErrorChattering(error="LOW_BATTERY", clear_for_s=None),
        ErrorChattering(error="DEVIATES", clear_for_s=12.5, part=PartName("arm")),
    ),
    "error.shelved": (
        ErrorShelved(error="LOW_BATTERY", for_s=12.5, reason='Größe ≤ 3 — "gripper\\jam"'),
        ErrorShelved(error="DEVIATES", for_s=12.5, reason="noise", part=PartName("arm")),
    ),
    "error.unshelved": (
        ErrorUnshelved(error="LOW_BATTERY"),
        ErrorUnshelved(error="DEVIATES", part=PartName("arm")),
    ),
    **DEVICE_EVENTS,
    **ERROR_EVENTS,
    "error.reported": (
        ErrorReported(
            part=PartName("left/arm"),
            error="JAMMED",
            active=True,
            message='Größe ≤ 3 — "gripper\\jam"',
            value=12.5,
        ),
    ),
    "goal.ended": (GoalEnded(goal=GoalId(5), succeeded=True, reason='Größe ≤ 3 — "gripper\\jam"'),),
    "goal.feedback": (GoalProgressed(goal=GoalId(5)),),
    "hold.release_requested": (HoldReleaseRequested(owner="operator"),),
    "hold.released": (HoldReleased(owner="operator"),),
    "hold.requested": (HoldRequested(owner="operator", reason='Größe ≤ 3 — "gripper\\jam"'),),
    "hold.set": (HoldSet(owner="operator", reason='Größe ≤ 3 — "gripper\\jam"'),),
    "node.answered": (
        NodeAnswered(node=PartName("left/arm"), accepted=True, reason='Größe ≤ 3 — "gripper\\jam"'),
    ),
    "node.not_restored": (
        NodeNotRestored(
            node=PartName("left/arm"),
            target=StateAndMode(state=LifecycleState.INACTIVE, mode=ModeName("FAST")),
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
    ),
    "node.reachable": (
        NodeReachable(node=PartName("left/arm")),
        NodeReachable(node=PartName("left/arm"), with_device=True),
    ),
    "node.reported": (
        NodeReported(
            node=PartName("left/arm"),
            state=LifecycleState.INACTIVE,
            mode=ModeName("FAST"),
            parameters=PARAMETERS,
            reachable=True,
        ),
        NodeReported(
            node=PartName("left/arm"), state=None, mode=None, parameters=None, reachable=None
        ),
    ),
    "node.restoring": (
        NodeRestoring(
            node=PartName("left/arm"),
            target=StateAndMode(state=LifecycleState.INACTIVE, mode=ModeName("FAST")),
        ),
    ),
    "node.unreachable": (
        NodeUnreachable(node=PartName("left/arm")),
        NodeUnreachable(node=PartName("left/arm"), with_device=True),
    ),
    "part.actual_changed": (
        PartActualChanged(
            part=PartName("arm"),
            actual=StateAndMode(state=LifecycleState.INACTIVE, mode=ModeName("FAST")),
            was=StateAndMode(state=LifecycleState.INACTIVE, mode=ModeName("FAST")),
            reason='Größe ≤ 3 — "gripper\\jam"',
            of_system=True,
        ),
        PartActualChanged(
            part=PartName("arm"),
            actual=StateAndMode(state=LifecycleState.INACTIVE, mode=ModeName("FAST")),
            was=StateAndMode(state=LifecycleState.INACTIVE, mode=ModeName("FAST")),
            reason='Größe ≤ 3 — "gripper\\jam"',
            of_system=False,
        ),
    ),
    "part.deviation_began": (
        DeviationBegan(
            part=PartName("arm"),
            target=StateAndMode(state=LifecycleState.INACTIVE, mode=ModeName("FAST")),
            actual=StateAndMode(state=LifecycleState.INACTIVE, mode=ModeName("FAST")),
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
    ),
    "checkpoint.reached": (CheckpointReached(node=PartName("left/arm"), checkpoint="cycle"),),
    "part.deviation_ended": (
        DeviationEnded(
            part=PartName("arm"),
            target=StateAndMode(state=LifecycleState.INACTIVE, mode=ModeName("FAST")),
            actual=StateAndMode(state=LifecycleState.INACTIVE, mode=ModeName("FAST")),
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
    ),
    "ros.fault": (GraphFaultFound(fault="qos", name="/scan", reason="best effort publisher"),),
    "ros.fault_ended": (GraphFaultEnded(fault="duplicate", name="/left/arm"),),
    "service.not_restored": (NotRestored(what="node left/arm", reason="not in the model"),),
    "service.restored": (
        ServiceRestored(
            boot=4,
            targets=2,
            changes=1,
            tasks=1,
            holds=3,
            errors=0,
            emergency_stop=True,
            reason="the store was broken",
        ),
    ),
    "storage.degraded": (StorageDegraded(reason="disk full"),),
    "storage.recovered": (StorageRecovered(),),
    "service.stalled": (ServiceStalled(late_s=0.4),),
    "signal.pending": (SignalPending(signal="battery_level", error="LOW_BATTERY"),),
    "signal.read": (
        SignalRead(source="ros", values={"battery_level": 12.5, "estop": True, "gear": "R"}),
    ),
    "signal.settled": (SignalSettled(signal="battery_level", error="LOW_BATTERY", stale=True),),
    "signal.not_read": (
        SignalNotRead(signal="disk", source="os disk /", reason='Größe ≤ 3 — "gripper\\jam"'),
    ),
    "signal.limits_changed": (
        SignalLimitsChanged(signal="load", because="left/arm.FAST", above=60.0),
        SignalLimitsChanged(signal="load", because=None),
    ),
    "signal.skewed": (SignalSkewed(signal="battery_level"),),
    "propagation.not_seen": (
        PropagationNotSeen(
            error="LATE",
            part=PartName("mapper"),
            cause_error="SILENT",
            cause_part=PartName("left/arm"),
            within_s=2.0,
        ),
    ),
    "reaction.acting": (
        ReactionActing(
            part=PartName("left/arm"),
            reaction="LIMP",
            action=Action.MODE,
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
    ),
    "reaction.ended": (
        ReactionEnded(
            part=PartName("left/arm"),
            reaction="LIMP",
            action=Action.MODE,
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
    ),
    "reaction.would_act": (
        ReactionWouldAct(
            part=PartName("left/arm"),
            reaction="LIMP",
            action=Action.MODE,
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
    ),
    "reaction.overruled": (
        ReactionOverruled(
            part=PartName("left/arm"),
            reaction="LIMP",
            action=Action.MODE,
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
    ),
    "reaction.exhausted": (
        ReactionExhausted(
            part=PartName("left/arm"),
            reaction="LIMP",
            action=Action.MODE,
            instead=Action.HOLD,
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
    ),
    "reaction.arm_requested": (
        ReactionArmRequested(
            part=PartName("left/arm"),
            reaction="LIMP",
            arm=Arm.DISARMED,
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
    ),
    "reaction.acknowledged": (ReactionAcknowledged(part=PartName("left/arm"), reaction="LIMP"),),
    "rule.not_applied": (
        RuleNotApplied(
            part=PartName("left/arm"),
            rule="slow_down",
            target=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("SLOW")),
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
    ),
    "target.displacement_began": (
        DisplacementBegan(
            part=PartName("left/arm"),
            target=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("SLOW")),
            was=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("FAST")),
            because=Because.RULE,
            rule="slow_down",
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
        DisplacementBegan(
            part=PartName("left/arm"),
            target=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("SLOW")),
            was=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("FAST")),
            because=Because.INVARIANT,
            rule=None,
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
        DisplacementBegan(
            part=PartName("left/arm"),
            target=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("SLOW")),
            was=None,
            because=Because.REACTION,
            rule=None,
            reason='Größe ≤ 3 — "gripper\\jam"',
            reaction="LIMP",
        ),
    ),
    "target.displacement_ended": (
        DisplacementEnded(
            part=PartName("left/arm"),
            target=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("FAST")),
            was=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("SLOW")),
            because=Because.RULE,
            rule="slow_down",
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
        DisplacementEnded(
            part=PartName("left/arm"),
            target=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("FAST")),
            was=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("SLOW")),
            because=Because.INVARIANT,
            rule=None,
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
        DisplacementEnded(
            part=PartName("left/arm"),
            target=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("SLOW")),
            was=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("SLOW")),
            because=Because.REACTION,
            rule=None,
            reason='Größe ≤ 3 — "gripper\\jam"',
            reaction="LIMP",
        ),
    ),
    "target.displacement_stays": (
        DisplacementStays(
            part=PartName("left/arm"),
            target=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("SLOW")),
            because=Because.RULE,
            rule="slow_down",
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
        DisplacementStays(
            part=PartName("left/arm"),
            target=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("SLOW")),
            because=Because.INVARIANT,
            rule=None,
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
        DisplacementStays(
            part=PartName("left/arm"),
            target=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("SLOW")),
            because=Because.REACTION,
            rule=None,
            reason='Größe ≤ 3 — "gripper\\jam"',
            reaction="LIMP",
        ),
    ),
    "system_state.changed": (
        SystemStateChanged(
            state=SystemState.ERROR,
            was=SystemState.ERROR,
            errors=("ESTOP", "STALE_DATA"),
            error_code=68,
        ),
    ),
    "task.aborted": (
        TaskAborted(
            task=TaskId("3"), reason='Größe ≤ 3 — "gripper\\jam"', progress=0.30000000000000004
        ),
    ),
    "task.cancel_requested": (TaskCancelRequested(),),
    "task.canceled": (
        TaskCanceled(
            task=TaskId("3"), reason='Größe ≤ 3 — "gripper\\jam"', progress=0.30000000000000004
        ),
    ),
    "task.paused": (TaskPaused(task=TaskId("3"), reason='Größe ≤ 3 — "gripper\\jam"'),),
    "task.pausing": (TaskPausing(task=TaskId("3"), reason='Größe ≤ 3 — "gripper\\jam"'),),
    "task.requested": (
        TaskRequested(
            waypoints=120, length_m=98.5, start_index=2, controller="stanley", speed_mps=1.5
        ),
    ),
    "task.resumed": (TaskResumed(task=TaskId("3"), goal=GoalId(5), target_index=12),),
    "task.served": (TaskServed(task=TaskId("3"), waypoints=120, length_m=98.5),),
    "task.started": (TaskStarted(task=TaskId("3"), goal=GoalId(5), target_index=12),),
    "task.succeeded": (
        TaskSucceeded(
            task=TaskId("3"), reason='Größe ≤ 3 — "gripper\\jam"', progress=0.30000000000000004
        ),
    ),
    "time.passed": (TimeWasDue(),),
    "vehicle.reported": (VehicleReported(x_m=-12.25, y_m=1e-07, speed_mps=1.5),),
    "vehicle.standstill_unknown": (VehicleStandstillUnknown(after_s=2.5),),
    "vehicle.still_moving": (VehicleStillMoving(speed_mps=1.5, after_s=2.5),),
    "vehicle.stopped": (VehicleStopped(after_s=2.5),),
}
