"""The name of each class in records.

Names, names of fields and defaults are a format that is read for years: a class may be renamed,
its name here may not. A field may be added with a default; a default never changes, since a field
that holds it may be left out. `tests/data/codec` has a sample of each, which every later release
must read.
"""

from collections.abc import Mapping

from domain import commands, controller, inputs, kept, process_terms
from domain.actor import Actor
from domain.events.event import RecordedEvent
from domain.events.kinds import EVENTS
from domain.graph_terms import GraphFault
from domain.link import messages
from service.codec.recorded_step import RecordedStep

NAMES: Mapping[type, str] = {
    Actor: "actor",
    RecordedEvent: "recorded_event",
    RecordedStep: "recorded_step",
    # Inputs.
    inputs.NodeReport: "node_report",
    inputs.NodeAnswer: "node_answer",
    inputs.Readings: "readings",
    inputs.CheckpointReport: "checkpoint_report",
    inputs.SourceFault: "source_fault",
    inputs.VehicleReport: "vehicle_report",
    inputs.DriveStatus: "drive_status",
    process_terms.ProcessReport: "process_report",
    inputs.BackendStatus: "backend_status",
    inputs.ReportBacklog: "report_backlog",
    inputs.StorageStatus: "storage_status",
    GraphFault: "graph_fault",
    inputs.GoalFeedback: "goal_feedback",
    inputs.GoalResult: "goal_result",
    controller.ControllerStatus: "controller_status",
    controller.ControllerAnswer: "controller_answer",
    controller.ControllerFeedback: "controller_feedback",
    controller.ControllerResult: "controller_result",
    controller.NavigationStatus: "navigation_status",
    inputs.TimePassed: "time_passed",
    inputs.ServiceStall: "service_stall",
    inputs.WriteRecord: "write_record",
    inputs.ModeRequest: "mode_request",
    inputs.TransitionRequest: "transition_request",
    inputs.ParametersRequest: "parameters_request",
    inputs.CancelRequest: "cancel_request",
    inputs.EmergencyStopRequest: "emergency_stop_request",
    inputs.AcknowledgeRequest: "acknowledge_request",
    inputs.ErrorReport: "error_report",
    inputs.ArmRequest: "arm_request",
    inputs.AcknowledgeReactionRequest: "acknowledge_reaction_request",
    inputs.ShelveRequest: "shelve_request",
    inputs.UnshelveRequest: "unshelve_request",
    process_terms.ProcessRequest: "process_request",
    inputs.TaskRequest: "task_request",
    inputs.CancelTaskRequest: "cancel_task_request",
    inputs.HoldRequest: "hold_request",
    inputs.ReleaseRequest: "release_request",
    inputs.DeviceStatus: "device_status",
    inputs.SupervisorStatus: "supervisor_status",
    inputs.PeerStops: "peer_stops",
    inputs.StopsReleased: "stops_released",
    inputs.ReactionReport: "reaction_report",
    inputs.OrderReceived: "order_received",
    inputs.Restored: "restored",
    # Commands.
    commands.AskTransition: "ask_transition",
    commands.AskParameters: "ask_parameters",
    commands.AskFacts: "ask_facts",
    commands.Drive: "drive",
    commands.SendGoal: "send_goal",
    commands.PreemptGoal: "preempt_goal",
    commands.StartProcess: "start_process",
    commands.StopProcess: "stop_process",
    commands.TellStops: "tell_stops",
    commands.AskRelease: "ask_release",
    commands.AnswerOrder: "answer_order",
    commands.ActAlone: "act_alone",
    commands.TellReaction: "tell_reaction",
    # Messages of the link.
    messages.Beat: "beat",
    messages.Report: "report",
    messages.NodeOrder: "node_order",
    # What is kept.
    kept.Keeping: "keeping",
    kept.KeptTarget: "kept_target",
    kept.KeptEffectiveTarget: "kept_effective_target",
    kept.KeptChange: "kept_change",
    kept.KeptEmergencyStop: "kept_emergency_stop",
    kept.KeptPeerStops: "kept_peer_stops",
    kept.KeptError: "kept_error",
    kept.KeptUnacknowledged: "kept_unacknowledged",
    kept.KeptShelf: "kept_shelf",
    kept.KeptClock: "kept_clock",
    kept.KeptFailedChange: "kept_failed_change",
    kept.KeptReport: "kept_report",
    kept.KeptHold: "kept_hold",
    kept.KeptReaction: "kept_reaction",
    kept.KeptBound: "kept_bound",
    kept.KeptProcess: "kept_process",
    kept.KeptTask: "kept_task",
    kept.KeptProgress: "kept_progress",
    # Events have the name that clients know as well.
    **{event: kind for kind, event in EVENTS.items()},
}
