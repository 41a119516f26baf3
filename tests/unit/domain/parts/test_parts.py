"""What can be seen of parts, and what is told of them."""

import pytest

from domain.computers import ComputerName
from domain.events.changes import ChangeRequested, StepStarted
from domain.events.event import RecordedEvent
from domain.events.parts import NodeUnreachable
from domain.findings import Blocker
from domain.identifiers import ChangeId
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parts.parts import LOOKS_AT_ONCE, Parts
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.snapshot import Because, EffectiveTarget, ParameterView
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from tests.support.big_model import big_model
from tests.support.models import ACTUATION, ARM, BASE, active, inactive, nested_model

LIDAR, ROBOT = PartName("lidar"), PartName("robot")
S = LifecycleState


class Robot:
    """The parts of a robot whose nodes report by hand."""

    def __init__(self, model: SmhModel | None = None) -> None:
        self.outbox = Outbox()
        self.parts = Parts(model or nested_model(), self.outbox)

    def report(self, report: NodeReport, now: int = 0) -> tuple[RecordedEvent, ...]:
        self.parts.take_report(report, now)
        self.parts.settle(now)
        return self.outbox.take().events

    def ask(self, part: PartName, target: StateAndMode, now: int = 0) -> tuple[RecordedEvent, ...]:
        self.outbox.begin(now, ChangeRequested(part))
        self.parts.ask({part: target})
        self.parts.settle(now)
        return self.outbox.take().events


@pytest.fixture
def robot() -> Robot:
    return Robot()


def _told(events: tuple[RecordedEvent, ...], kind: str) -> list[dict[str, object]]:
    return [dict(event.data) for event in events if event.kind == kind]


# --- views ---------------------------------------------------------------------------------------


def test_a_system_is_shown_with_its_parts_and_a_node_without(robot: Robot) -> None:
    system, node = robot.parts.view(ACTUATION), robot.parts.view(BASE)
    assert (system.name, system.kind, system.parts) == (ACTUATION, "system", (ARM, BASE))
    assert (node.name, node.kind, node.parts) == (BASE, "node", ())


def test_all_parts_are_shown_systems_first(robot: Robot) -> None:
    assert list(robot.parts.views()) == [ACTUATION, ROBOT, BASE, ARM, LIDAR]


def test_what_is_asked_is_what_is_pursued(robot: Robot) -> None:
    robot.ask(BASE, active("FAST"))
    view = robot.parts.view(BASE)
    assert view.target == active("FAST")
    assert view.effective_target == EffectiveTarget(S.ACTIVE, ModeName("FAST"), Because.REQUESTED)


def test_a_part_that_nothing_was_asked_of_has_no_target(robot: Robot) -> None:
    view = robot.parts.view(BASE)
    assert (view.target, view.effective_target, view.converged) == (None, None, True)


def test_a_view_stays_the_same_object_until_something_about_its_part_changes(
    robot: Robot,
) -> None:
    before = robot.parts.views()
    robot.report(NodeReport(LIDAR, state=S.INACTIVE))
    after = robot.parts.views()
    changed = {part for part in before if before[part] is not after[part]}
    assert changed == {LIDAR, ROBOT}


def test_a_report_that_says_nothing_new_changes_no_view(robot: Robot) -> None:
    robot.report(NodeReport(LIDAR, state=S.INACTIVE))
    before = robot.parts.views()
    assert robot.report(NodeReport(LIDAR, state=S.INACTIVE)) == ()
    assert all(before[part] is view for part, view in robot.parts.views().items())


# --- parameters ----------------------------------------------------------------------------------


def test_parameters_are_shown_with_what_the_target_mode_wants_of_them(robot: Robot) -> None:
    robot.report(NodeReport(BASE, parameters={"max_speed": 0.5, "extra": 1}))
    robot.ask(BASE, active("FAST"))
    assert robot.parts.parameters(BASE) == (
        ParameterView("controller", None, "MPC"),
        ParameterView("extra", 1, None),
        ParameterView("max_speed", 0.5, 0.9),
    )


def test_a_target_without_a_mode_wants_the_parameters_of_default(robot: Robot) -> None:
    robot.ask(ARM, StateAndMode(S.ACTIVE))
    assert robot.parts.parameters(ARM) == (ParameterView("max_torque", None, 0.1),)


@pytest.mark.parametrize("target", [None, inactive()])
def test_of_a_node_that_shall_not_be_active_no_values_are_wanted(
    robot: Robot, target: StateAndMode | None
) -> None:
    if target is not None:
        robot.ask(ARM, target)
    assert robot.parts.parameters(ARM) == (ParameterView("max_torque", None, None),)


def test_a_node_without_modes_shows_what_it_reports() -> None:
    pump = PartName("pump")
    robot = Robot(SmhModel({pump: NodeModel(pump)}, {}))
    robot.ask(pump, StateAndMode(S.ACTIVE))
    robot.report(NodeReport(pump, parameters={"rate": 3}))
    assert robot.parts.parameters(pump) == (ParameterView("rate", 3, None),)


# --- reachable -----------------------------------------------------------------------------------


def test_a_system_is_reachable_when_all_its_nodes_are(robot: Robot) -> None:
    robot.report(NodeReport(BASE, reachable=True))
    assert not robot.parts.view(ACTUATION).reachable
    robot.report(NodeReport(ARM, reachable=True))
    assert robot.parts.view(ACTUATION).reachable
    assert not robot.parts.view(ROBOT).reachable
    robot.report(NodeReport(LIDAR, reachable=True))
    assert robot.parts.view(ROBOT).reachable


def test_a_node_that_is_lost_takes_all_systems_above_with_it(robot: Robot) -> None:
    for node in (BASE, ARM, LIDAR):
        robot.report(NodeReport(node, reachable=True))
    events = robot.report(NodeReport(BASE, reachable=False))
    assert _told(events, "node.unreachable") == [{"node": BASE}]
    reachable = {part: view.reachable for part, view in robot.parts.views().items()}
    assert reachable == {ACTUATION: False, ROBOT: False, BASE: False, ARM: True, LIDAR: True}


def test_a_node_that_is_lost_twice_is_told_and_counted_once(robot: Robot) -> None:
    for node in (BASE, ARM):
        robot.report(NodeReport(node, reachable=True))
    robot.report(NodeReport(BASE, reachable=False))
    assert _told(robot.report(NodeReport(BASE, reachable=False)), "node.unreachable") == []
    assert _told(robot.report(NodeReport(BASE, reachable=True)), "node.reachable") == [
        {"node": BASE}
    ]
    assert robot.parts.view(ACTUATION).reachable


def test_a_node_that_only_one_mode_names_counts_as_every_other() -> None:
    extra = ModeName("EXTRA")
    nodes = {name: NodeModel(name) for name in (BASE, ARM)}
    modes = {DEFAULT_MODE: {BASE: inactive()}, extra: {BASE: inactive(), ARM: inactive()}}
    robot = Robot(SmhModel(nodes, {ACTUATION: SystemModel(ACTUATION, modes)}))
    robot.report(NodeReport(ARM, reachable=True))
    assert not robot.parts.view(ACTUATION).reachable
    robot.report(NodeReport(BASE, reachable=True))
    assert robot.parts.view(ACTUATION).reachable


# --- what is told --------------------------------------------------------------------------------


def test_what_a_part_is_in_now_is_told_with_what_it_was_in(robot: Robot) -> None:
    robot.report(NodeReport(LIDAR, state=S.INACTIVE))
    events = robot.report(NodeReport(LIDAR, state=S.ACTIVE, parameters={"rate": 20}))
    assert _told(events, "part.actual_changed") == [
        {"part": LIDAR, "actual": "active.WIDE", "was": "inactive", "reason": None}
    ]


def test_the_first_state_of_a_part_was_unknown_before(robot: Robot) -> None:
    events = robot.report(NodeReport(LIDAR, state=S.INACTIVE))
    assert [data["was"] for data in _told(events, "part.actual_changed")] == ["unknown"]


def test_a_part_that_stays_unknown_is_no_news(robot: Robot) -> None:
    """Neither when it is asked for something, nor when there is another reason."""
    assert _told(robot.ask(ROBOT, active("RACE")), "part.actual_changed") == []
    events = robot.report(NodeReport(BASE, reachable=False))
    assert _told(events, "part.actual_changed") == []


def test_another_reason_is_seen_though_it_is_not_told(robot: Robot) -> None:
    robot.report(NodeReport(ARM, state=S.INACTIVE))
    before = robot.parts.view(ACTUATION).actual.reason
    robot.report(NodeReport(BASE, reachable=False))
    after = robot.parts.view(ACTUATION).actual.reason
    assert (before, after) == (
        "drive_base has never reported a state",
        "drive_base is unreachable",
    )


# --- deviations ----------------------------------------------------------------------------------


def test_a_deviation_is_told_when_it_begins_and_when_it_ends(robot: Robot) -> None:
    robot.report(NodeReport(LIDAR, state=S.INACTIVE), now=1)
    began = robot.ask(LIDAR, active("WIDE"), now=2)
    assert {"part": LIDAR, "target": "active.WIDE", "actual": "inactive", "reason": None} in _told(
        began, "part.deviation_began"
    )
    report = NodeReport(LIDAR, state=S.ACTIVE, parameters={"rate": 20})
    ended = robot.report(report, now=3)
    told = {"part": LIDAR, "target": "active.WIDE", "actual": "active.WIDE", "reason": None}
    assert told in _told(ended, "part.deviation_ended")


def test_a_deviation_counts_from_its_beginning_whatever_comes_in_between(robot: Robot) -> None:
    robot.ask(LIDAR, active("WIDE"), now=2)
    robot.report(NodeReport(LIDAR, state=S.CONFIGURING), now=3)
    view = robot.parts.view(LIDAR)
    assert (view.converged, view.deviation_since) == (False, 2)


def test_a_deviation_that_ended_is_forgotten(robot: Robot) -> None:
    robot.ask(LIDAR, active("WIDE"), now=2)
    robot.ask(LIDAR, StateAndMode(S.UNKNOWN), now=3)
    view = robot.parts.view(LIDAR)
    assert (view.converged, view.deviation_since) == (True, None)


def test_a_system_deviates_when_a_part_of_it_leaves_on_its_own(robot: Robot) -> None:
    for node in (BASE, ARM):
        robot.report(NodeReport(node, state=S.INACTIVE))
    robot.ask(ACTUATION, inactive())
    events = robot.report(NodeReport(ARM, state=S.ACTIVE), now=7)
    told = _told(events, "part.deviation_began")
    assert [data["part"] for data in told] == [ACTUATION, ROBOT], "and so does what it belongs to"
    assert robot.parts.view(ACTUATION).deviation_since == 7


def test_a_system_that_is_called_inactive_has_not_converged_while_its_nodes_are_unconfigured(
    robot: Robot,
) -> None:
    for node in (BASE, ARM):
        robot.report(NodeReport(node, state=S.UNCONFIGURED))
    for part in (ARM, BASE):
        robot.ask(part, inactive())
    events = robot.ask(ACTUATION, inactive(), now=5)
    view = robot.parts.view(ACTUATION)
    assert (view.actual.state, view.converged, view.deviation_since) == (S.INACTIVE, False, 0)
    assert view.deviation_reason == "drive_base is unconfigured, target inactive"
    assert not _told(events, "part.deviation_began"), "it deviates already"


def test_the_events_of_a_system_name_the_part_that_is_not_there(robot: Robot) -> None:
    robot.report(NodeReport(BASE, state=S.UNCONFIGURED))
    robot.report(NodeReport(ARM, state=S.INACTIVE))
    robot.ask(ACTUATION, inactive())
    (*_, told) = _told(robot.ask(BASE, inactive()), "part.deviation_began")
    reason = "drive_base is unconfigured, target inactive"
    assert told == {"part": ROBOT, "target": None, "actual": "unknown", "reason": reason}


def test_a_reason_is_there_exactly_while_a_part_has_not_converged(robot: Robot) -> None:
    assert robot.parts.view(LIDAR).deviation_reason is None
    robot.ask(LIDAR, inactive())
    assert robot.parts.view(LIDAR).deviation_reason is not None
    robot.report(NodeReport(LIDAR, state=S.INACTIVE))
    assert robot.parts.view(LIDAR).deviation_reason is None


def test_a_part_that_stayed_as_it_was_does_not_hide_the_ones_after_it(robot: Robot) -> None:
    robot.report(NodeReport(ARM, state=S.INACTIVE))
    robot.report(NodeReport(LIDAR, state=S.INACTIVE))
    robot.parts.touch([ARM])
    told = _told(robot.report(NodeReport(LIDAR, state=S.ACTIVE)), "part.actual_changed")
    assert [data["part"] for data in told] == [LIDAR]


def test_a_node_that_is_reached_adds_to_what_changed_before(robot: Robot) -> None:
    robot.parts.touch([ARM])
    robot.parts.take_report(NodeReport(LIDAR, state=S.INACTIVE), 0)
    robot.parts.settle(0)
    assert robot.outbox.take().parts == {ARM, LIDAR, ROBOT}


def test_nothing_is_left_to_tell_once_the_parts_have_settled(robot: Robot) -> None:
    robot.parts.take_report(NodeReport(LIDAR, state=S.INACTIVE), 0)
    assert robot.parts.settle(0)
    assert not robot.parts.settle(0)


# --- what changes record -------------------------------------------------------------------------


def test_a_part_is_under_the_newest_change_until_that_lets_go(robot: Robot) -> None:
    robot.parts.put_under(ChangeId("c1"), [BASE])
    robot.parts.put_under(ChangeId("c2"), [BASE])
    robot.parts.let_go(ChangeId("c1"), [BASE])
    assert robot.parts.view(BASE).change == "c2"

    robot.parts.let_go(ChangeId("c2"), [BASE])
    robot.parts.settle(0)
    assert robot.parts.view(BASE).change is None


def test_a_report_of_a_node_at_a_step_is_a_consequence_of_it(robot: Robot) -> None:
    robot.outbox.begin(0, ChangeRequested(LIDAR))
    step = robot.outbox.emit(StepStarted(ChangeId("c1"), LIDAR, "configure"))
    robot.parts.expect_report(LIDAR, step)
    robot.outbox.take()

    first, *_ = robot.report(NodeReport(LIDAR, state=S.CONFIGURING))
    robot.parts.expect_nothing(LIDAR)
    then, *_ = robot.report(NodeReport(LIDAR, state=S.INACTIVE))

    assert (first.kind, first.cause) == ("node.reported", step)
    assert (then.kind, then.cause) == ("node.reported", None)


def test_what_a_node_was_in_before_its_report_is_known_after_it(robot: Robot) -> None:
    robot.report(NodeReport(LIDAR, state=S.ACTIVE))
    robot.report(NodeReport(LIDAR, state=S.UNCONFIGURED))
    assert robot.parts.state_before is S.ACTIVE


# --- a large robot -------------------------------------------------------------------------------

BIG = big_model(2_500)
ROOT = BIG.parts[0]


class LargeRobot(Robot):
    """A robot of which a request moves more parts than one turn tells."""

    def __init__(self) -> None:
        super().__init__(BIG)
        self.told: list[RecordedEvent] = []

    def ask_all(self, now: int) -> int:
        """Ask all parts to be active; return the event of the request."""
        self.outbox.begin(now, ChangeRequested(ROOT))
        cause = self.outbox.record_input()
        self.parts.ask(dict.fromkeys(BIG.parts, active("FAST")))
        self.parts.settle(now)
        self.told += self.outbox.take().events
        return cause

    def go_on(self, now: int) -> tuple[RecordedEvent, ...]:
        """Let one turn pass."""
        self.parts.go_on(now)
        self.parts.settle(now)
        events = self.outbox.take().events
        self.told += events
        return events

    def began(self) -> list[object]:
        """Return the parts whose deviation was told, in that order."""
        return [data["part"] for data in _told(tuple(self.told), "part.deviation_began")]


def test_what_a_request_changes_of_a_large_robot_is_told_in_later_turns_and_in_order() -> None:
    robot = LargeRobot()
    robot.ask_all(now=7)
    assert not robot.began()
    while robot.parts.has_more:
        robot.go_on(now=9)
        assert len(robot.began()) % LOOKS_AT_ONCE == 0 or not robot.parts.has_more
    assert robot.began() == sorted(BIG.parts)


def test_the_state_of_a_system_is_told_before_its_deviation() -> None:
    robot = LargeRobot()
    for node in BIG.nodes:
        robot.report(NodeReport(node, state=S.INACTIVE), now=1)
    robot.ask_all(now=7)
    while robot.parts.has_more:
        robot.go_on(now=9)
    assert [event.kind for event in robot.told[1:] if event.data.get("part") == ROOT] == [
        "part.actual_changed",
        "part.deviation_began",
    ]


def test_deviations_that_are_told_later_began_with_the_request() -> None:
    robot = LargeRobot()
    cause = robot.ask_all(now=7)
    at_once = robot.parts.views()
    while robot.parts.has_more:
        assert {event.cause for event in robot.go_on(now=9)} == {cause}
    assert robot.parts.views() == at_once
    assert {view.deviation_since for view in at_once.values()} == {7}
    assert not any(view.converged for view in at_once.values())


def test_a_node_that_reports_before_its_turn_is_told_to_have_deviated_first() -> None:
    robot = LargeRobot()
    cause = robot.ask_all(now=7)
    last = max(BIG.nodes)
    events = robot.report(NodeReport(last, state=S.ACTIVE, mode=ModeName("FAST")), now=8)
    of_it = [event for event in events if event.data.get("part") == last]
    assert [(event.kind, event.cause == cause) for event in of_it] == [
        ("part.deviation_began", True),
        ("part.actual_changed", False),
        ("part.deviation_ended", False),
    ]
    robot.told += events
    while robot.parts.has_more:
        robot.go_on(now=9)
    assert sorted(map(str, robot.began())) == sorted(BIG.parts), "each once"


# --- other computers -----------------------------------------------------------------------------


def test_a_node_names_the_computer_that_owns_it() -> None:
    parts = Parts(nested_model(), Outbox(), {ARM: ComputerName("arm")})

    assert parts.view(ARM).device == "arm"
    assert parts.view(BASE).device is None
    assert parts.view(ACTUATION).device is None


def test_a_node_that_is_lost_with_its_computer_is_told_with_it(robot: Robot) -> None:
    robot.report(NodeReport(ARM, S.INACTIVE, reachable=True))
    robot.parts.note_cut_off((ARM,), Blocker("DEVICE_LOST", "device arm is not connected", ()))

    (lost,) = [
        event.event
        for event in robot.report(NodeReport(ARM, reachable=False), 5)
        if isinstance(event.event, NodeUnreachable)
    ]

    assert lost.with_device
    assert robot.parts.view(ARM).actual.reason == (
        "manipulator is unreachable: device arm is not connected"
    )


def test_why_nothing_is_heard_changes_what_is_shown(robot: Robot) -> None:
    robot.parts.settle(0)
    robot.outbox.take()
    assert robot.parts.view(ARM).actual.reason == "manipulator has never reported a state"

    robot.parts.note_cut_off((ARM,), Blocker("DEVICE_LOST", "device arm is not connected", ()))
    robot.parts.settle(0)

    assert robot.outbox.take().parts == {ARM}
    assert robot.parts.view(ARM).actual.reason == (
        "manipulator has never reported a state: device arm is not connected"
    )


def test_a_robot_of_one_computer_awaits_nobody(robot: Robot) -> None:
    assert not robot.parts.awaits_devices
    robot.parts.await_devices(wait=True)
    assert robot.parts.awaits_devices
