"""How the target of a rule is put in force and taken back: what is told, begun and kept."""

from domain.actor import Actor
from domain.changes.settings import ChangeSettings
from domain.inputs import ModeRequest, NodeReport, TimePassed
from domain.lifecycle import LifecycleState
from domain.simulation.node_settings import Fault
from domain.snapshot import Because, ChangeStatus
from domain.state_and_mode import ModeName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from tests.support.kept_values import KeptValues
from tests.support.models import ACTUATION, ARM, BASE, active
from tests.support.ruled_robot import (
    DEGRADE,
    RuledRobot,
    degrading_model,
)

S = LifecycleState
DEFAULT = "active.__DEFAULT__"
BEGAN, ENDED = "target.displacement_began", "target.displacement_ended"
STAYS, NOT_APPLIED = "target.displacement_stays", "rule.not_applied"


def degrading() -> RuledRobot:
    return RuledRobot(degrading_model())


def test_the_rest_of_the_system_follows_and_what_was_requested_is_not_forgotten() -> None:
    robot = degrading().degraded()

    assert robot.actual("drive_base") == DEFAULT
    assert robot.core.part(ACTUATION).converged
    assert (robot.asked("actuation"), robot.asked("drive_base")) == (
        "active.PERFORMANCE",
        "active.FAST",
    )
    assert robot.target("drive_base") == f"{DEFAULT} by degrade", "inherited"
    assert robot.target("manipulator") == "inactive by degrade"


def test_who_set_a_target_and_why_is_shown_with_the_event_that_tells_it() -> None:
    robot = degrading().degraded()

    pursued = robot.pursued("drive_base")
    (began,) = (event for event in robot.events if event.kind == BEGAN)
    assert (pursued.because, pursued.rule, pursued.cause) == (Because.RULE, DEGRADE, began.id)
    assert began.actor == Actor("rule:degrade")
    assert began.data == {
        "part": "actuation",
        "target": DEFAULT,
        "was": "active.PERFORMANCE",
        "because": "rule",
        "rule": "degrade",
        "reason": "manipulator is inactive",
    }
    (blocker,) = pursued.blockers
    assert (blocker.code, blocker.path) == ("RULE", (ACTUATION, ARM))
    assert (blocker.message, blocker.refuses) == ("manipulator is inactive", False)
    reported = next(event for event in robot.events if event.id == began.cause)
    assert (reported.kind, reported.data["node"]) == ("node.reported", "manipulator")
    assert blocker.since == reported.at


def test_a_change_in_the_name_of_the_rule_leads_there() -> None:
    robot = degrading().degraded()

    change = robot.core.changes()[0]
    (began,) = (event for event in robot.events if event.kind == BEGAN)
    assert (change.part, change.request.actor.label) == (ACTUATION, "rule:degrade")
    assert (change.status, change.cause) == (ChangeStatus.SUCCEEDED, began.id)


def test_a_node_that_cannot_follow_does_not_keep_the_others_from_it() -> None:
    robot = degrading().in_performance()
    robot.fault("drive_base", Fault.REFUSE)
    robot.somebody_asks("manipulator", "deactivate")
    robot.advance(5)

    assert robot.core.changes()[0].status is ChangeStatus.FAILED
    assert robot.target("actuation") == f"{DEFAULT} by degrade"
    assert not robot.core.part(ACTUATION).converged


def test_what_keeps_a_system_from_returning_is_shown_until_it_is_gone() -> None:
    robot = degrading().degraded()
    robot.somebody_asks("drive_base", "shutdown")
    robot.somebody_asks("manipulator", "activate")
    robot.advance(5)
    assert robot.why("actuation") == [
        ("FINALIZED", "drive_base is finalized: its process must be restarted")
    ]
    assert robot.happened(ENDED) == []
    robot.somebody_asks("manipulator", "deactivate")
    assert robot.why("actuation") == [("RULE", "manipulator is inactive")]
    robot.somebody_asks("manipulator", "activate")
    robot.advance(5)
    assert [code for code, _ in robot.why("actuation")] == ["FINALIZED"]

    robot.fault("drive_base", Fault.DIE)
    robot.fault("drive_base", None)
    robot.advance(5)

    assert robot.actual("actuation") == "active.PERFORMANCE"


def test_a_node_that_reappears_is_restored_to_what_the_rule_set_and_nothing_is_asked_anew() -> None:
    restored = ChangeSettings(restored_nodes=frozenset({BASE}))
    robot = RuledRobot(degrading_model(), SupervisionSettings(changes=restored)).degraded()
    robot.fault("drive_base", Fault.DIE)
    robot.advance(2)
    robot.fault("drive_base", None)
    robot.advance(2)

    assert len(robot.happened("node.restoring")) == 1
    assert robot.actual("drive_base") == DEFAULT
    assert robot.asked("drive_base") == "active.FAST"
    assert robot.target("drive_base") == f"{DEFAULT} by degrade"


def test_a_node_that_turns_out_to_be_unconfigured_keeps_what_was_requested_of_it() -> None:
    core, kept = Supervision(degrading_model(), SupervisionSettings(), 0), KeptValues()
    modes = {node.name: node.modes for node in core.model.nodes.values()}
    for node, mode in ((BASE, "FAST"), (ARM, "STRONG")):
        values = modes[node][ModeName(mode)]
        core.handle(NodeReport(node, S.ACTIVE, parameters=values, reachable=True), 0)
    kept.take(core.handle(ModeRequest(ACTUATION, "PERFORMANCE"), 0))
    core.handle(NodeReport(ARM, reachable=False), seconds(5))
    core.handle(NodeReport(BASE, S.INACTIVE), seconds(5))
    kept.take(core.handle(TimePassed(), seconds(6)))
    kept.take(core.handle(NodeReport(ARM, S.UNCONFIGURED, reachable=True), seconds(7)))

    arm = core.part(ARM)
    assert arm.target == active("STRONG")
    assert arm.effective_target is not None
    assert (arm.effective_target.state, arm.effective_target.rule) == (S.UNCONFIGURED, "park")

    again = Supervision(degrading_model(), SupervisionSettings(), seconds(8))
    again.handle(kept.restored(), seconds(8))
    assert again.part(ARM).effective_target == arm.effective_target
    assert again.part(BASE).effective_target == core.part(BASE).effective_target
