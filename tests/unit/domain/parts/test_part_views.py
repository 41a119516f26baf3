"""What can be seen of parts, and what is told of them."""

import pytest

from domain.changes.operations import Changes
from domain.changes.record import ChangeSettings
from domain.events import Event
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parts.mode_inference import ModeInference
from domain.parts.part_views import PartViews
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.snapshot import EffectiveTarget, ParameterView
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from tests.support.models import ACTUATION, ARM, BASE, active, inactive, nested_model

LIDAR, ROBOT = PartName("lidar"), PartName("robot")
S = LifecycleState


class Views:
    """The views of a robot whose nodes report by hand."""

    def __init__(self, model: SmhModel | None = None) -> None:
        self.model = model or nested_model()
        self.inference = ModeInference(self.model)
        self.outbox = Outbox()
        changes = Changes(self.inference, ChangeSettings(), self.outbox, lambda: False)
        self.views = PartViews(self.inference, changes, self.outbox)

    def report(self, report: NodeReport, now: int = 0) -> tuple[Event, ...]:
        self.outbox.begin(now, "node.reported")
        changed = self.inference.report(report)
        self.views.note_reachable(report.node)
        self.views.note_actuals(changed)
        self.views.settle(now)
        return self.outbox.take().events

    def ask(self, part: PartName, target: StateAndMode | None, now: int = 0) -> tuple[Event, ...]:
        self.outbox.begin(now, "change.requested")
        self.outbox.parts |= {part, *self.inference.set_targets({part: target})}
        self.views.note_actuals(self.outbox.parts)
        self.views.settle(now)
        return self.outbox.take().events


@pytest.fixture
def robot() -> Views:
    return Views()


def _told(events: tuple[Event, ...], kind: str) -> list[dict[str, object]]:
    return [dict(event.data) for event in events if event.kind == kind]


# --- views ---------------------------------------------------------------------------------------


def test_a_system_is_shown_with_its_parts_and_a_node_without(robot: Views) -> None:
    system, node = robot.views.get(ACTUATION), robot.views.get(BASE)
    assert (system.name, system.kind, system.parts) == (ACTUATION, "system", (ARM, BASE))
    assert (node.name, node.kind, node.parts) == (BASE, "node", ())


def test_all_parts_are_shown_systems_first(robot: Views) -> None:
    assert list(robot.views.all()) == [ACTUATION, ROBOT, BASE, ARM, LIDAR]


def test_what_is_asked_is_what_is_pursued(robot: Views) -> None:
    robot.ask(BASE, active("FAST"))
    view = robot.views.get(BASE)
    assert view.target == active("FAST")
    assert view.effective_target == EffectiveTarget(S.ACTIVE, ModeName("FAST"), "requested")


def test_a_part_that_nothing_was_asked_of_has_no_target(robot: Views) -> None:
    view = robot.views.get(BASE)
    assert (view.target, view.effective_target, view.converged) == (None, None, True)


def test_a_view_stays_the_same_object_until_something_about_its_part_changes(
    robot: Views,
) -> None:
    before = robot.views.all()
    robot.report(NodeReport(LIDAR, state=S.INACTIVE))
    after = robot.views.all()
    changed = {part for part in before if before[part] is not after[part]}
    assert changed == {LIDAR, ROBOT}


def test_a_report_that_says_nothing_new_changes_no_view(robot: Views) -> None:
    robot.report(NodeReport(LIDAR, state=S.INACTIVE))
    before = robot.views.all()
    assert robot.report(NodeReport(LIDAR, state=S.INACTIVE)) == ()
    assert all(before[part] is view for part, view in robot.views.all().items())


# --- parameters ----------------------------------------------------------------------------------


def test_parameters_are_shown_with_what_the_target_mode_wants_of_them(robot: Views) -> None:
    robot.report(NodeReport(BASE, parameters={"max_speed": 0.5, "extra": 1}))
    robot.ask(BASE, active("FAST"))
    assert robot.views.parameters(BASE) == (
        ParameterView("controller", None, "MPC"),
        ParameterView("extra", 1, None),
        ParameterView("max_speed", 0.5, 0.9),
    )


def test_a_target_without_a_mode_wants_the_parameters_of_default(robot: Views) -> None:
    robot.ask(ARM, StateAndMode(S.ACTIVE))
    assert robot.views.parameters(ARM) == (ParameterView("max_torque", None, 0.1),)


@pytest.mark.parametrize("target", [None, inactive()])
def test_of_a_node_that_shall_not_be_active_no_values_are_wanted(
    robot: Views, target: StateAndMode | None
) -> None:
    robot.ask(ARM, target)
    assert robot.views.parameters(ARM) == (ParameterView("max_torque", None, None),)


def test_a_node_without_modes_shows_what_it_reports() -> None:
    pump = PartName("pump")
    robot = Views(SmhModel({pump: NodeModel(pump)}, {}))
    robot.ask(pump, StateAndMode(S.ACTIVE))
    robot.report(NodeReport(pump, parameters={"rate": 3}))
    assert robot.views.parameters(pump) == (ParameterView("rate", 3, None),)


# --- reachable -----------------------------------------------------------------------------------


def test_a_system_is_reachable_when_all_its_nodes_are(robot: Views) -> None:
    robot.report(NodeReport(BASE, reachable=True))
    assert not robot.views.get(ACTUATION).reachable
    robot.report(NodeReport(ARM, reachable=True))
    assert robot.views.get(ACTUATION).reachable
    assert not robot.views.get(ROBOT).reachable
    robot.report(NodeReport(LIDAR, reachable=True))
    assert robot.views.get(ROBOT).reachable


def test_a_node_that_is_lost_takes_all_systems_above_with_it(robot: Views) -> None:
    for node in (BASE, ARM, LIDAR):
        robot.report(NodeReport(node, reachable=True))
    events = robot.report(NodeReport(BASE, reachable=False))
    assert _told(events, "node.unreachable") == [{"node": BASE}]
    reachable = {part: view.reachable for part, view in robot.views.all().items()}
    assert reachable == {ACTUATION: False, ROBOT: False, BASE: False, ARM: True, LIDAR: True}


def test_a_node_that_is_lost_twice_is_told_and_counted_once(robot: Views) -> None:
    for node in (BASE, ARM):
        robot.report(NodeReport(node, reachable=True))
    robot.report(NodeReport(BASE, reachable=False))
    assert _told(robot.report(NodeReport(BASE, reachable=False)), "node.unreachable") == []
    assert _told(robot.report(NodeReport(BASE, reachable=True)), "node.reachable") == [
        {"node": BASE}
    ]
    assert robot.views.get(ACTUATION).reachable


def test_a_node_that_only_one_mode_names_counts_as_every_other() -> None:
    extra = ModeName("EXTRA")
    nodes = {name: NodeModel(name) for name in (BASE, ARM)}
    modes = {DEFAULT_MODE: {BASE: inactive()}, extra: {BASE: inactive(), ARM: inactive()}}
    robot = Views(SmhModel(nodes, {ACTUATION: SystemModel(ACTUATION, modes)}))
    robot.report(NodeReport(ARM, reachable=True))
    assert not robot.views.get(ACTUATION).reachable
    robot.report(NodeReport(BASE, reachable=True))
    assert robot.views.get(ACTUATION).reachable


# --- what is told --------------------------------------------------------------------------------


def test_what_a_part_is_in_now_is_told_with_what_it_was_in(robot: Views) -> None:
    robot.report(NodeReport(LIDAR, state=S.INACTIVE))
    events = robot.report(NodeReport(LIDAR, state=S.ACTIVE, parameters={"rate": 20}))
    assert _told(events, "part.actual_changed") == [
        {"part": LIDAR, "actual": "active.WIDE", "was": "inactive", "reason": None}
    ]


def test_the_first_state_of_a_part_was_unknown_before(robot: Views) -> None:
    events = robot.report(NodeReport(LIDAR, state=S.INACTIVE))
    assert [data["was"] for data in _told(events, "part.actual_changed")] == ["unknown"]


def test_a_part_that_stays_unknown_is_no_news(robot: Views) -> None:
    """Neither when it is asked for something, nor when there is another reason."""
    assert _told(robot.ask(ROBOT, active("RACE")), "part.actual_changed") == []
    events = robot.report(NodeReport(BASE, reachable=False))
    assert _told(events, "part.actual_changed") == []


def test_another_reason_is_seen_though_it_is_not_told(robot: Views) -> None:
    robot.report(NodeReport(ARM, state=S.INACTIVE))
    before = robot.views.get(ACTUATION).actual.reason
    robot.report(NodeReport(BASE, reachable=False))
    after = robot.views.get(ACTUATION).actual.reason
    assert (before, after) == (
        "drive_base has never reported a state",
        "drive_base is unreachable",
    )


# --- deviations ----------------------------------------------------------------------------------


def test_a_deviation_is_told_when_it_begins_and_when_it_ends(robot: Views) -> None:
    robot.report(NodeReport(LIDAR, state=S.INACTIVE), now=1)
    began = robot.ask(LIDAR, active("WIDE"), now=2)
    assert _told(began, "part.deviation_began") == [
        {"part": LIDAR, "target": "active.WIDE", "actual": "inactive", "reason": None}
    ]
    report = NodeReport(LIDAR, state=S.ACTIVE, parameters={"rate": 20})
    ended = robot.report(report, now=3)
    assert _told(ended, "part.deviation_ended") == [
        {"part": LIDAR, "target": "active.WIDE", "actual": "active.WIDE", "reason": None}
    ]


def test_a_deviation_counts_from_its_beginning_whatever_comes_in_between(robot: Views) -> None:
    robot.ask(LIDAR, active("WIDE"), now=2)
    robot.report(NodeReport(LIDAR, state=S.CONFIGURING), now=3)
    view = robot.views.get(LIDAR)
    assert (view.converged, view.deviation_since) == (False, 2)


def test_a_deviation_that_ended_is_forgotten(robot: Views) -> None:
    robot.ask(LIDAR, active("WIDE"), now=2)
    robot.ask(LIDAR, None, now=3)
    view = robot.views.get(LIDAR)
    assert (view.converged, view.deviation_since) == (True, None)


def test_a_system_deviates_when_a_part_of_it_leaves_on_its_own(robot: Views) -> None:
    for node in (BASE, ARM):
        robot.report(NodeReport(node, state=S.INACTIVE))
    robot.ask(ACTUATION, inactive())
    events = robot.report(NodeReport(ARM, state=S.ACTIVE), now=7)
    (told,) = _told(events, "part.deviation_began")
    assert told["part"] == ACTUATION
    assert robot.views.get(ACTUATION).deviation_since == 7


def test_a_part_that_stayed_as_it_was_does_not_hide_the_ones_after_it(robot: Views) -> None:
    robot.report(NodeReport(ARM, state=S.INACTIVE))
    robot.report(NodeReport(LIDAR, state=S.INACTIVE))
    robot.outbox.begin(0, "node.reported")
    robot.inference.report(NodeReport(LIDAR, state=S.ACTIVE))
    robot.views.note_actuals([ARM, LIDAR])
    told = _told(robot.outbox.take().events, "part.actual_changed")
    assert [data["part"] for data in told] == [LIDAR]


def test_a_node_that_is_reached_adds_to_what_changed_before(robot: Views) -> None:
    robot.outbox.begin(0, "node.reported")
    robot.outbox.parts.add(ARM)
    robot.inference.report(NodeReport(LIDAR, state=S.INACTIVE))
    robot.views.note_reachable(LIDAR)
    assert robot.outbox.take().parts == {ARM, LIDAR, ROBOT}
