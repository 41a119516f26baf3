"""A value or two of each command, of what is kept, and of an event as it is recorded."""

from collections.abc import Mapping

from domain.actor import Actor
from domain.commands import (
    ActAlone,
    AnswerOrder,
    AskFacts,
    AskParameters,
    AskRelease,
    AskTransition,
    Drive,
    PreemptGoal,
    SendGoal,
    TellReaction,
    TellStops,
)
from domain.computers import ComputerName, PeerStop, StopId
from domain.events.changes import StepEnded
from domain.events.event import RecordedEvent
from domain.events.service import TimeWasDue
from domain.identifiers import ChangeId, GoalId, TaskId
from domain.inputs import TimePassed
from domain.kept import (
    Keeping,
    KeptBound,
    KeptChange,
    KeptClock,
    KeptEffectiveTarget,
    KeptEmergencyStop,
    KeptError,
    KeptFailedChange,
    KeptHold,
    KeptPeerStops,
    KeptProgress,
    KeptReaction,
    KeptReport,
    KeptShelf,
    KeptTarget,
    KeptTask,
    KeptUnacknowledged,
)
from domain.lifecycle import LifecycleState, Transition
from domain.reaction_terms import Arm, ReactionState
from domain.snapshot import StepStatus
from domain.state_and_mode import ModeName, PartName, StateAndMode
from domain.vehicle import DriveCommand, Pose, VehicleState
from service.codec.recorded_step import RecordedStep
from tests.support.record_samples.pieces import PARAMETERS, PATH

OTHERS: Mapping[str, tuple[object, ...]] = {
    "ask_transition": (
        AskTransition(request=41, node=PartName("left/arm"), transition=Transition.ACTIVATE),
    ),
    "ask_parameters": (AskParameters(request=41, node=PartName("left/arm"), values=PARAMETERS),),
    "ask_facts": (AskFacts(request=41, node=PartName("left/arm")),),
    "drive": (Drive(command=DriveCommand(speed_mps=1.5, steering_angle_rad=0.0625)),),
    "send_goal": (
        SendGoal(
            goal=GoalId(5),
            path=PATH,
            first_index=1,
            start_index=2,
            controller="stanley",
            speed_mps=1.5,
            reached_m=20.5,
            left_out_m=0.75,
        ),
        SendGoal(
            goal=GoalId(5),
            path=PATH,
            first_index=1,
            start_index=2,
            controller="stanley",
            speed_mps=1.5,
            reached_m=0.0,
            left_out_m=0.0,
        ),
    ),
    "preempt_goal": (PreemptGoal(goal=GoalId(5)),),
    "tell_stops": (
        TellStops(
            stops=(
                PeerStop(
                    id=StopId("supervisor-a5a5-3"),
                    by="ada",
                    reason='Größe ≤ 3 — "gripper\\jam"',
                    since=1764420000123456789,
                ),
            )
        ),
        TellStops(stops=()),
    ),
    "ask_release": (
        AskRelease(computer=ComputerName("arm"), stops=(StopId("arm-0f0f-3"),)),
        AskRelease(computer=ComputerName("arm"), stops=()),
    ),
    "answer_order": (
        AnswerOrder(
            request=41,
            node=PartName("left/arm"),
            accepted=False,
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
        AnswerOrder(request=41, node=PartName("left/arm"), accepted=True, reason=""),
    ),
    "act_alone": (ActAlone(autonomous=True),),
    "tell_reaction": (
        TellReaction(part=PartName("left/arm"), reaction="LIMP", state=ReactionState.IDLE),
    ),
    "actor": (
        Actor(name="ada", way="http", address="10.0.0.7"),
        Actor(name="", way="", address=""),
    ),
    "recorded_step": (
        RecordedStep(
            at=1764420000123456789,
            given=TimePassed(),
            is_late=True,
            commands=(Drive(command=DriveCommand(speed_mps=1.5, steering_angle_rad=0.0625)),),
            events=(RecordedEvent(41, 1764420000123456789, None, Actor(), TimeWasDue()),),
            kept=(Keeping(kind=KeptHold, name="operator", value=None),),
            views=4294967295,
        ),
        RecordedStep(
            at=0, given=TimePassed(), is_late=False, commands=(), events=(), kept=(), views=None
        ),
    ),
    "recorded_event": (
        RecordedEvent(
            id=41,
            at=1764420000123456789,
            cause=40,
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
            event=StepEnded(
                change=ChangeId("17"),
                node=PartName("left/arm"),
                action="activate",
                status=StepStatus.SUCCEEDED,
                error="LOW_BATTERY",
            ),
        ),
    ),
    "keeping": (
        Keeping(
            kind=KeptTarget,
            name="arm",
            value=KeptTarget(
                part=PartName("arm"),
                target=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("FAST")),
                order=9,
            ),
        ),
        Keeping(kind=KeptHold, name="operator", value=None),
    ),
    "kept_target": (
        KeptTarget(
            part=PartName("arm"),
            target=StateAndMode(state=LifecycleState.INACTIVE, mode=ModeName("FAST")),
            order=9,
            staying={PartName("left/arm"): LifecycleState.UNCONFIGURED},
        ),
        KeptTarget(
            part=PartName("arm"),
            target=StateAndMode(state=LifecycleState.INACTIVE, mode=ModeName("FAST")),
            order=9,
            staying={},
        ),
    ),
    "kept_effective_target": (
        KeptEffectiveTarget(
            part=PartName("arm"),
            target=StateAndMode(state=LifecycleState.INACTIVE),
            rule="slow_down",
            order=2,
            after=9,
            cause=40,
            since=1764420000123456789,
            staying={PartName("left/arm"): LifecycleState.UNCONFIGURED},
        ),
        KeptEffectiveTarget(
            part=PartName("arm"),
            target=StateAndMode(state=LifecycleState.INACTIVE),
            rule="slow_down",
            order=2,
            after=9,
            cause=40,
            since=1764420000123456789,
        ),
        KeptEffectiveTarget(
            part=PartName("arm"),
            target=StateAndMode(state=LifecycleState.ACTIVE, mode=ModeName("SLOW")),
            rule=None,
            order=3,
            after=9,
            cause=41,
            since=1764420000123456789,
            because="invariant",
        ),
        KeptEffectiveTarget(
            part=PartName("arm"),
            target=StateAndMode(state=LifecycleState.INACTIVE),
            rule="LIMP",
            order=4,
            after=9,
            cause=42,
            since=1764420000123456789,
            because="reaction",
        ),
    ),
    "kept_change": (
        KeptChange(
            id=ChangeId("3"),
            part=PartName("arm"),
            started_at=1764420000123456789,
            cause=40,
            mode="FAST",
            transition=Transition.ACTIVATE,
            parameters=PARAMETERS,
        ),
        KeptChange(
            id=ChangeId("3"),
            part=PartName("arm"),
            started_at=1764420000123456789,
            cause=40,
            mode=None,
            transition=None,
            parameters=None,
        ),
    ),
    "kept_emergency_stop": (
        KeptEmergencyStop(
            engaged=True, by="ada", reason='Größe ≤ 3 — "gripper\\jam"', since=1764420000123456789
        ),
        KeptEmergencyStop(
            engaged=True,
            by="ada",
            reason="a child",
            since=1764420000123456789,
            id="9f86d081884c7d65-31",
        ),
    ),
    "kept_peer_stops": (
        KeptPeerStops(
            computer=ComputerName("arm"),
            stops=(
                PeerStop(
                    id=StopId("0f0f-3"),
                    by="ada",
                    reason='Größe ≤ 3 — "gripper\\jam"',
                    since=1764420000123456789,
                ),
            ),
        ),
    ),
    "kept_error": (
        KeptError(
            signal="battery_level",
            error="LOW_BATTERY",
            since=1764420000123456789,
            message="12.5 % < 20 %",
        ),
        KeptError(
            signal="scan_rate",
            error="SCAN_SLOW",
            since=1764420000123456789,
            message="scan rate 3 Hz is below 8 Hz",
            part=PartName("lidar"),
        ),
    ),
    "kept_unacknowledged": (
        KeptUnacknowledged(
            part=PartName("arm"),
            error="DEVIATES",
            message="12.5 % < 20 %",
            since=1764420000123456789,
            value="active.SLOW",
            threshold=12.5,
        ),
        KeptUnacknowledged(
            part=None,
            error="LOW_BATTERY",
            message="12.5 % < 20 %",
            since=1764420000123456789,
            value=None,
            threshold=None,
        ),
    ),
    "kept_shelf": (
        KeptShelf(
            part=PartName("arm"),
            error="DEVIATES",
            until=1764420000123456789,
            reason='Größe ≤ 3 — "gripper\\jam"',
            by="ada",
        ),
        KeptShelf(
            part=None, error="LOW_BATTERY", until=1764420000123456789, reason="noise", by="ada"
        ),
    ),
    "kept_clock": (KeptClock(at=1764420000123456789),),
    "kept_failed_change": (
        KeptFailedChange(
            part=PartName("arm"),
            change=ChangeId("3"),
            message="change 3 failed: 12.5 % < 20 %",
            status="failed",
            since=1764420000123456789,
        ),
    ),
    "kept_report": (
        KeptReport(
            part=PartName("left/arm"),
            error="JAMMED",
            message='Größe ≤ 3 — "gripper\\jam"',
            value=12.5,
            since=1764420000123456789,
        ),
    ),
    "kept_bound": (
        KeptBound(kind="rule", bounded="left/arm.SLOW", ages=(2_000_000_000, 0)),
        KeptBound(kind="rule_return", bounded="arm"),
    ),
    "kept_hold": (
        KeptHold(
            owner="operator",
            reason='Größe ≤ 3 — "gripper\\jam"',
            by="ada",
            since=1764420000123456789,
        ),
    ),
    "kept_reaction": (
        KeptReaction(
            part=PartName("left/arm"),
            reaction="LIMP",
            arm=Arm.PASSIVE,
            since=1764420000123456789,
            is_exhausted=True,
            is_acknowledged=True,
            escalated=True,
            used=(5_000_000_000, 250_000_000),
        ),
        KeptReaction(
            part=PartName("left/arm"),
            reaction="LIMP",
            arm=None,
            since=None,
            is_exhausted=False,
            is_acknowledged=False,
            escalated=False,
            used=(),
        ),
    ),
    "kept_task": (
        KeptTask(
            id=TaskId("3"),
            path=PATH,
            controller="stanley",
            speed_mps=1.5,
            start_index=2,
            created_at=1764420000123456789,
            cause=40,
        ),
    ),
    "kept_progress": (
        KeptProgress(
            task=TaskId("3"),
            has_run=True,
            target_index=12,
            distance_m=51.3,
            left_out_m=0.75,
            cross_track_error_m=-0.125,
            ended_as="ABORTED",
            reason='Größe ≤ 3 — "gripper\\jam"',
            ended_at=1764420001123456789,
            seen=VehicleState(
                pose=Pose(x_m=-12.25, y_m=1e-07, yaw_rad=-3.125),
                speed_mps=1.5,
                steering_angle_rad=0.0625,
            ),
        ),
        KeptProgress(
            task=TaskId("3"),
            has_run=True,
            target_index=12,
            distance_m=51.3,
            left_out_m=0.75,
            cross_track_error_m=None,
            ended_as=None,
            reason=None,
            ended_at=None,
            seen=None,
        ),
    ),
}
