"""A value or two of each input: with all fields, and with every default."""

from collections.abc import Mapping
from math import inf, nan

from domain.actor import Actor
from domain.commands import AskParameters, AskTransition
from domain.computers import (
    SUPERVISOR,
    ComputerName,
    DeviceState,
    Incarnation,
    PeerStop,
    Session,
    StopId,
)
from domain.controller import (
    ControllerAnswer,
    ControllerFeedback,
    ControllerResult,
    ControllerStatus,
    GoalOutcome,
    NavigationStatus,
)
from domain.graph_terms import GraphFault, GraphFaultKind
from domain.identifiers import ChangeId, GoalId
from domain.inputs import (
    AcknowledgeReactionRequest,
    AcknowledgeRequest,
    ArmRequest,
    BackendStatus,
    CancelRequest,
    CancelTaskRequest,
    CheckpointReport,
    DeviceStatus,
    DriveStatus,
    EmergencyStopRequest,
    ErrorReport,
    GoalFeedback,
    GoalResult,
    HoldRequest,
    ModeRequest,
    NodeAnswer,
    NodeReport,
    OrderReceived,
    ParametersRequest,
    PeerStops,
    ReactionReport,
    Reading,
    Readings,
    ReleaseRequest,
    ReportBacklog,
    Restored,
    ServiceStall,
    ShelveRequest,
    SourceFault,
    StopsReleased,
    StorageStatus,
    SupervisorStatus,
    TaskRequest,
    TimePassed,
    TransitionRequest,
    UnshelveRequest,
    VehicleReport,
    WriteRecord,
)
from domain.lifecycle import LifecycleState, Transition
from domain.reaction_terms import Arm, ReactionState
from domain.state_and_mode import ModeName, PartName
from domain.vehicle import DriveCommand, Point, Pose, VehicleState
from tests.support.record_samples.pieces import KEPT, PARAMETERS, PATH

INPUTS: Mapping[str, tuple[object, ...]] = {
    "node_report": (
        NodeReport(
            node=PartName("left/arm"),
            state=LifecycleState.INACTIVE,
            mode=ModeName("FAST"),
            parameters=PARAMETERS,
            reachable=True,
            has_lifecycle=True,
        ),
        NodeReport(
            node=PartName("left/arm"),
            state=None,
            mode=None,
            parameters=None,
            reachable=None,
            has_lifecycle=None,
        ),
    ),
    "checkpoint_report": (
        CheckpointReport(
            node=PartName("left/arm"),
            checkpoint="cycle",
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
        ),
        CheckpointReport(
            node=PartName("left/arm"),
            checkpoint="cycle",
            actor=Actor(name="", way="", address=""),
        ),
    ),
    "node_answer": (
        NodeAnswer(
            request=41,
            node=PartName("left/arm"),
            accepted=True,
            reason='Größe ≤ 3 — "gripper\\jam"',
        ),
        NodeAnswer(request=41, node=PartName("left/arm"), accepted=True, reason=""),
    ),
    "readings": (
        Readings(
            items=(Reading(signal="battery_level", value=12.5, stamp=1764419999987654321),),
            source="ros",
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
        ),
        Readings(
            items=(Reading(signal="battery_level", value=12.5, stamp=1764419999987654321),),
            source="ros",
            actor=Actor(name="", way="", address=""),
        ),
        Readings(
            items=(
                Reading(signal="speed", value=nan),
                Reading(signal="speed", value=-inf),
                Reading(signal="laps", value=3),
                Reading(signal="estop", value=False),
                Reading(signal="gear", value="nan"),
            ),
            source="ros",
            actor=Actor(name="", way="", address=""),
        ),
    ),
    "vehicle_report": (
        VehicleReport(
            state=VehicleState(
                pose=Pose(x_m=-12.25, y_m=1e-07, yaw_rad=-3.125),
                speed_mps=1.5,
                steering_angle_rad=0.0625,
            )
        ),
    ),
    "source_fault": (
        SourceFault(signal="disk", source="os disk /", reason='Größe ≤ 3 — "gripper\\jam"'),
    ),
    "drive_status": (
        DriveStatus(available=True, reason='Größe ≤ 3 — "gripper\\jam"'),
        DriveStatus(available=True, reason=""),
    ),
    "backend_status": (
        BackendStatus(available=True, reason='Größe ≤ 3 — "gripper\\jam"'),
        BackendStatus(available=True, reason=""),
    ),
    "storage_status": (
        StorageStatus(available=False, reason="disk full"),
        StorageStatus(available=True, reason=""),
    ),
    "graph_fault": (
        GraphFault(kind=GraphFaultKind.QOS, name="/scan", reason='Größe ≤ 3 — "gripper\\jam"'),
        GraphFault(kind=GraphFaultKind.DUPLICATE, name="/left/arm", reason=""),
    ),
    "report_backlog": (ReportBacklog(source="ros", since=1764420000123456789),),
    "goal_feedback": (
        GoalFeedback(
            goal=GoalId(5),
            target_index=12,
            distance_m=51.3,
            cross_track_error_m=-0.125,
            lookahead=Point(x_m=-12.25, y_m=1e-07),
            command=DriveCommand(speed_mps=1.5, steering_angle_rad=0.0625),
            left_out_m=0.75,
        ),
        GoalFeedback(
            goal=GoalId(5),
            target_index=12,
            distance_m=51.3,
            cross_track_error_m=-0.125,
            lookahead=Point(x_m=-12.25, y_m=1e-07),
            command=DriveCommand(speed_mps=1.5, steering_angle_rad=0.0625),
            left_out_m=0.0,
        ),
        GoalFeedback(
            goal=GoalId(5),
            target_index=12,
            distance_m=51.3,
            cross_track_error_m=-0.125,
            lookahead=None,
            command=None,
        ),
    ),
    "controller_status": (
        ControllerStatus(available=False, reason="there is no controller at /navigate_waypoints"),
        ControllerStatus(available=True),
    ),
    "controller_answer": (
        ControllerAnswer(goal=GoalId(5), accepted=False, reason='Größe ≤ 3 — "gripper\\jam"'),
        ControllerAnswer(goal=GoalId(5), accepted=True),
    ),
    "controller_feedback": (ControllerFeedback(goal=GoalId(5), target_index=12, progress=0.25),),
    "controller_result": (
        ControllerResult(goal=GoalId(5), end=GoalOutcome.ABORTED, reason="the battery is empty"),
        ControllerResult(goal=GoalId(5), end=GoalOutcome.SUCCEEDED),
    ),
    "navigation_status": (
        NavigationStatus(available=False, reason="the controller gave no feedback for 1 s"),
        NavigationStatus(available=True),
    ),
    "goal_result": (
        GoalResult(goal=GoalId(5), succeeded=True, reason='Größe ≤ 3 — "gripper\\jam"'),
        GoalResult(goal=GoalId(5), succeeded=True, reason=""),
    ),
    "time_passed": (TimePassed(),),
    "service_stall": (ServiceStall(late=400000000),),
    "write_record": (
        WriteRecord(
            method="POST",
            path="/tasks",
            status=201,
            address="10.0.0.7",
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
        ),
        WriteRecord(
            method="POST",
            path="/tasks",
            status=201,
            address="10.0.0.7",
            actor=Actor(name="", way="", address=""),
        ),
    ),
    "mode_request": (
        ModeRequest(
            part=PartName("arm"),
            mode="FAST",
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
        ),
        ModeRequest(part=PartName("arm"), mode="FAST", actor=Actor(name="", way="", address="")),
        ModeRequest(part=PartName("arm"), mode="FAST", wait_for=30_000_000_000),
    ),
    "transition_request": (
        TransitionRequest(
            part=PartName("arm"),
            transition=Transition.ACTIVATE,
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
        ),
        TransitionRequest(
            part=PartName("arm"),
            transition=Transition.ACTIVATE,
            actor=Actor(name="", way="", address=""),
        ),
    ),
    "parameters_request": (
        ParametersRequest(
            node=PartName("left/arm"),
            values=PARAMETERS,
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
        ),
        ParametersRequest(
            node=PartName("left/arm"), values=PARAMETERS, actor=Actor(name="", way="", address="")
        ),
    ),
    "cancel_request": (
        CancelRequest(
            change=ChangeId("17"), actor=Actor(name="ada", way="http", address="10.0.0.7")
        ),
        CancelRequest(change=ChangeId("17"), actor=Actor(name="", way="", address="")),
    ),
    "emergency_stop_request": (
        EmergencyStopRequest(
            engaged=True,
            reason='Größe ≤ 3 — "gripper\\jam"',
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
        ),
        EmergencyStopRequest(
            engaged=True,
            reason='Größe ≤ 3 — "gripper\\jam"',
            actor=Actor(name="", way="", address=""),
        ),
        EmergencyStopRequest(
            engaged=False,
            reason="the track is clear",
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
            stops=(StopId("arm-0f0f-3"),),
        ),
    ),
    "acknowledge_request": (
        AcknowledgeRequest(
            error="LOW_BATTERY", actor=Actor(name="ada", way="http", address="10.0.0.7")
        ),
        AcknowledgeRequest(error="LOW_BATTERY", actor=Actor(name="", way="", address="")),
        AcknowledgeRequest(
            error="DEVIATES",
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
            part=PartName("arm"),
        ),
    ),
    "shelve_request": (
        ShelveRequest(
            error="DEVIATES",
            for_=600_000_000_000,
            reason='Größe ≤ 3 — "gripper\\jam"',
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
            part=PartName("arm"),
        ),
        ShelveRequest(error="LOW_BATTERY", for_=1, reason="noise", actor=Actor(), part=None),
    ),
    "unshelve_request": (
        UnshelveRequest(
            error="DEVIATES",
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
            part=PartName("arm"),
        ),
        UnshelveRequest(error="LOW_BATTERY", actor=Actor(), part=None),
    ),
    "error_report": (
        ErrorReport(
            part=PartName("left/arm"),
            error="JAMMED",
            active=True,
            message='Größe ≤ 3 — "gripper\\jam"',
            value=12.5,
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
        ),
        ErrorReport(part=None, error="JAMMED", active=False),
    ),
    "arm_request": (
        ArmRequest(
            part=PartName("left/arm"),
            reaction="LIMP",
            arm=Arm.PASSIVE,
            reason='Größe ≤ 3 — "gripper\\jam"',
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
        ),
        ArmRequest(
            part=PartName("left/arm"),
            reaction="LIMP",
            arm=Arm.PASSIVE,
            reason="",
            actor=Actor(name="", way="", address=""),
        ),
    ),
    "acknowledge_reaction_request": (
        AcknowledgeReactionRequest(
            part=PartName("left/arm"),
            reaction="LIMP",
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
        ),
        AcknowledgeReactionRequest(
            part=PartName("left/arm"),
            reaction="LIMP",
            actor=Actor(name="", way="", address=""),
        ),
    ),
    "task_request": (
        TaskRequest(
            path=PATH,
            start_index=2,
            controller="stanley",
            speed_mps=1.5,
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
        ),
        TaskRequest(
            path=PATH,
            start_index=2,
            controller="stanley",
            speed_mps=1.5,
            actor=Actor(name="", way="", address=""),
        ),
    ),
    "cancel_task_request": (
        CancelTaskRequest(actor=Actor(name="ada", way="http", address="10.0.0.7")),
        CancelTaskRequest(actor=Actor(name="", way="", address="")),
    ),
    "hold_request": (
        HoldRequest(
            owner="operator",
            reason='Größe ≤ 3 — "gripper\\jam"',
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
        ),
        HoldRequest(
            owner="operator",
            reason='Größe ≤ 3 — "gripper\\jam"',
            actor=Actor(name="", way="", address=""),
        ),
    ),
    "release_request": (
        ReleaseRequest(owner="operator", actor=Actor(name="ada", way="http", address="10.0.0.7")),
        ReleaseRequest(owner="operator", actor=Actor(name="", way="", address="")),
    ),
    "device_status": (
        DeviceStatus(
            device=ComputerName("arm"),
            state=DeviceState.LOST,
            reason='Größe ≤ 3 — "gripper\\jam"',
            incarnation=Incarnation("0f" * 16),
            session=Session("a5" * 16),
            version="0.9.1",
            autonomous=True,
            refused="another computer calls itself arm",
        ),
        DeviceStatus(
            device=ComputerName("arm"),
            state=DeviceState.CONNECTED,
            reason="",
            incarnation=None,
            session=None,
            version=None,
            autonomous=False,
            refused="",
        ),
    ),
    "supervisor_status": (
        SupervisorStatus(
            state=DeviceState.LATE,
            reason="nothing heard for 0.5 s",
            incarnation=Incarnation("0f" * 16),
        ),
        SupervisorStatus(state=DeviceState.NEVER_SEEN, reason="", incarnation=None),
    ),
    "peer_stops": (
        PeerStops(
            computer=ComputerName("arm"),
            stops=(
                PeerStop(
                    id=StopId("arm-0f0f-3"),
                    by="ada",
                    reason='Größe ≤ 3 — "gripper\\jam"',
                    since=1764420000123456789,
                ),
            ),
        ),
        PeerStops(computer=SUPERVISOR, stops=(), ended=(StopId("supervisor-a5a5-3"),)),
        PeerStops(computer=SUPERVISOR, stops=(), ended=None),
        PeerStops(computer=SUPERVISOR, stops=(), ended=(), is_dealt_with=True),
    ),
    "stops_released": (
        StopsReleased(stops=(StopId("arm-0f0f-3"),), computer=SUPERVISOR),
        StopsReleased(stops=(), computer=ComputerName("arm")),
    ),
    "reaction_report": (
        ReactionReport(part=PartName("left/arm"), reaction="LIMP", state=ReactionState.ACTING),
    ),
    "order_received": (
        OrderReceived(
            command=AskTransition(
                request=41, node=PartName("left/arm"), transition=Transition.ACTIVATE
            )
        ),
        OrderReceived(
            command=AskParameters(request=42, node=PartName("left/arm"), values=PARAMETERS)
        ),
    ),
    "restored": (
        Restored(
            kept=KEPT,
            boot=4,
            next_event=10001,
            next_change=18,
            next_task=4,
            stop_because="the store was broken",
        ),
        Restored(kept=(), boot=1, next_event=1, next_change=1, next_task=1, stop_because=""),
        Restored(boot=2, next_event=31, run="9f86d081884c7d65"),
    ),
}
