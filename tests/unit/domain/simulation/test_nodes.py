import gc
import time
from typing import NamedTuple

import pytest

from domain.commands import AskTransition
from domain.errors import (
    InvalidValueError,
    RefusedError,
    UnknownParameterError,
    UnknownPartError,
)
from domain.inputs import NodeAnswer, NodeReport
from domain.lifecycle import TRANSITIONS, LifecycleState, Transition, TransitionRule, rule_for
from domain.parameters import Parameters, ParameterValue
from domain.parts.system_model import NodeModel, SmhModel
from domain.simulation.node_settings import Fault, NodeSettings
from domain.simulation.nodes import NodeMessage, SimulatedNodes
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName
from domain.timebase import seconds
from tests.support.models import ARM, BASE, actuation_model
from tests.support.recorded_nodes import RecordedNodes, answers, states
from tests.support.tables import table

S = LifecycleState
T = Transition
NOWHERE = PartName("nowhere")
PATHS_TO = {
    S.UNCONFIGURED: (),
    S.INACTIVE: (T.CONFIGURE,),
    S.ACTIVE: (T.CONFIGURE, T.ACTIVATE),
    S.FINALIZED: (T.SHUTDOWN,),
}


def robot_with(fault: Fault | None) -> RecordedNodes:
    """Return a robot that has said hello, with something wrong with its drive base from then on."""
    robot = RecordedNodes()
    robot.pass_time(1.0)
    robot.set_fault(BASE, fault)
    return robot


def reachability(said: list[tuple[float, NodeMessage]]) -> list[tuple[float, bool]]:
    return [
        (t, m.reachable) for t, m in said if isinstance(m, NodeReport) and m.reachable is not None
    ]


# --- appearing -----------------------------------------------------------------------------------


def test_all_nodes_say_at_once_that_they_are_unconfigured_and_were_told_nothing() -> None:
    robot = RecordedNodes()

    assert robot.pass_time(0.0) == [
        (
            0.0,
            NodeReport(
                BASE,
                state=S.UNCONFIGURED,
                parameters={"max_speed": 0.0, "controller": "none"},
                reachable=True,
                has_lifecycle=True,
            ),
        ),
        (
            0.0,
            NodeReport(
                ARM,
                state=S.UNCONFIGURED,
                parameters={"max_torque": 0.0},
                reachable=True,
                has_lifecycle=True,
            ),
        ),
    ]


def test_a_robot_at_rest_wants_nothing() -> None:
    robot = RecordedNodes()
    robot.pass_time(0.0)

    assert robot.nodes.wake_at() is None


def test_a_plain_node_has_parameters_and_no_lifecycle() -> None:
    robot = RecordedNodes({BASE: NodeSettings(plain=True)})
    (_, first), _ = robot.pass_time(0.0)
    request = robot.ask(BASE, T.CONFIGURE)

    assert isinstance(first, NodeReport)
    assert (first.state, first.has_lifecycle, first.reachable) == (None, False, True)
    assert answers(robot.pass_time(1.0)) == [
        NodeAnswer(request, BASE, False, "the node has no lifecycle")
    ]
    assert robot.nodes.state_of(BASE) is S.UNKNOWN


# --- transitions ---------------------------------------------------------------------------------


def test_a_transition_is_answered_at_once_and_reported_on_its_way_and_at_its_end() -> None:
    robot = robot_with(None)
    request = robot.ask(BASE, T.CONFIGURE)

    assert robot.pass_time(5.0) == [
        (1.0, NodeAnswer(request, BASE, True)),
        (1.0, NodeReport(BASE, state=S.CONFIGURING)),
        (1.3, NodeReport(BASE, state=S.INACTIVE)),
    ]


@pytest.mark.parametrize("rule", TRANSITIONS, ids=lambda rule: f"{rule.transition}-{rule.start}")
def test_every_line_of_the_lifecycle_table_can_be_walked(rule: TransitionRule) -> None:
    robot = RecordedNodes()
    robot.bring(BASE, *PATHS_TO[rule.start])
    robot.ask(BASE, rule.transition)

    assert [state for _, state in states(robot.pass_time(10.0))] == [rule.via, rule.success]


@pytest.mark.parametrize(
    ("start", "transition"),
    [(s, t) for s in PATHS_TO for t in T if rule_for(s, t) is None],
)
def test_a_transition_that_is_not_in_the_table_is_refused_and_changes_nothing(
    start: LifecycleState, transition: Transition
) -> None:
    robot = RecordedNodes()
    robot.bring(BASE, *PATHS_TO[start])
    request = robot.ask(BASE, transition)

    assert [m for _, m in robot.pass_time(10.0)] == [
        NodeAnswer(request, BASE, False, f"the node is {start}: it cannot {transition}")
    ]
    assert robot.nodes.state_of(BASE) is start


def test_a_transition_asked_while_another_runs_is_refused_and_the_other_goes_on() -> None:
    robot = robot_with(None)
    robot.ask(BASE, T.CONFIGURE)
    robot.pass_time(0.1)
    second = robot.ask(BASE, T.SHUTDOWN)

    said = robot.pass_time(5.0)

    assert answers(said) == [
        NodeAnswer(second, BASE, False, "the node is configuring: it cannot shutdown")
    ]
    assert states(said) == [(1.3, S.INACTIVE)]


def test_one_node_does_not_wait_for_another() -> None:
    slow = NodeSettings(configure=seconds(60.0))
    robot = RecordedNodes({BASE: slow})
    robot.pass_time(0.0)
    robot.ask(BASE, T.CONFIGURE)
    robot.ask(ARM, T.CONFIGURE)

    said = robot.pass_time(60.0)

    assert [(t, m) for t, m in said if isinstance(m, NodeReport) and m.state is S.INACTIVE] == [
        (0.3, NodeReport(ARM, state=S.INACTIVE)),
        (60.0, NodeReport(BASE, state=S.INACTIVE)),
    ]


def test_what_is_due_at_the_same_time_comes_in_the_order_in_which_it_was_asked() -> None:
    robot = robot_with(None)
    robot.ask(ARM, T.CONFIGURE)
    robot.ask(BASE, T.CONFIGURE)
    robot.pass_time(0.29)

    assert [m.node for _, m in robot.pass_time(1.0)] == [ARM, BASE]


def test_a_command_for_a_node_that_is_not_there_is_answered_with_a_refusal() -> None:
    robot = robot_with(None)
    request = robot.ask(NOWHERE, T.CONFIGURE)

    assert robot.pass_time(1.0) == [
        (1.0, NodeAnswer(request, NOWHERE, False, "there is no such node"))
    ]


# --- parameters ----------------------------------------------------------------------------------


def test_parameters_are_set_all_at_once_then_answered_and_reported() -> None:
    robot = robot_with(None)
    request = robot.ask_parameters(BASE, {"max_speed": 0.5, "controller": "MPC"})

    assert robot.pass_time(1.0) == [
        (1.02, NodeAnswer(request, BASE, True)),
        (1.02, NodeReport(BASE, parameters={"max_speed": 0.5, "controller": "MPC"})),
    ]
    assert robot.nodes.parameters_of(BASE) == {"max_speed": 0.5, "controller": "MPC"}


def test_what_was_asked_is_set_whatever_became_of_the_request_meanwhile() -> None:
    robot = robot_with(None)
    values: dict[str, ParameterValue] = {"max_speed": 0.5}
    robot.ask_parameters(BASE, values)
    values["max_speed"] = 7.0
    robot.pass_time(1.0)

    assert robot.nodes.parameters_of(BASE)["max_speed"] == 0.5


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"max_speed": 0.5, "wheels": 3}, "there is no parameter 'wheels'"),
        ({"max_speed": 0.5, "controller": 7}, "controller is of type string, not integer"),
    ],
)
def test_one_wrong_parameter_and_none_is_set(values: dict[str, float], reason: str) -> None:
    robot = robot_with(None)
    before = robot.nodes.parameters_of(BASE)
    request = robot.ask_parameters(BASE, values)

    assert [m for _, m in robot.pass_time(1.0)] == [NodeAnswer(request, BASE, False, reason)]
    assert robot.nodes.parameters_of(BASE) == before


def test_parameters_that_are_set_to_what_they_are_are_reported_too() -> None:
    # As in ROS 2; whoever asked for them sees that they are there.
    robot = robot_with(None)
    robot.ask_parameters(BASE, {"max_speed": 0.0})

    assert (1.02, NodeReport(BASE, parameters={"max_speed": 0.0})) in robot.pass_time(1.0)


def test_parameters_are_set_one_set_after_the_other() -> None:
    robot = robot_with(Fault.SLOW)
    first = robot.ask_parameters(BASE, {"max_speed": 0.1})
    robot.set_fault(BASE, None)
    second = robot.ask_parameters(BASE, {"max_speed": 0.2})

    said = robot.pass_time(1.0)

    assert [answer.request for answer in answers(said)] == [first, second]
    assert robot.nodes.parameters_of(BASE)["max_speed"] == 0.2


def test_a_mode_may_name_parameters_that_the_default_mode_does_not() -> None:
    lamp = PartName("lamp")
    modes: dict[ModeName, Parameters] = {
        DEFAULT_MODE: {"on": True},
        ModeName("DIM"): {"on": True, "brightness": 3},
    }
    robot = RecordedNodes(model=SmhModel({lamp: NodeModel(lamp, modes)}, {}))

    assert robot.nodes.parameters_of(lamp) == {"on": False, "brightness": 0}


def test_parameters_changed_from_outside_are_reported_at_once() -> None:
    robot = robot_with(None)
    robot.nodes.set_parameters(BASE, {"max_speed": 0.3}, robot.now)

    assert robot.pass_time(0.0) == [(1.0, NodeReport(BASE, parameters={"max_speed": 0.3}))]


def test_wrong_parameters_from_outside_change_nothing() -> None:
    robot = robot_with(None)

    with pytest.raises(UnknownParameterError):
        robot.nodes.set_parameters(BASE, {"max_speed": 0.3, "wheels": 3}, robot.now)
    with pytest.raises(InvalidValueError):
        robot.nodes.set_parameters(BASE, {"controller": "PID", "max_speed": 1}, robot.now)

    assert robot.nodes.parameters_of(BASE) == {"max_speed": 0.0, "controller": "none"}
    assert robot.pass_time(1.0) == []


def test_parameters_of_a_dead_node_cannot_be_changed_from_outside() -> None:
    robot = robot_with(Fault.DIE)

    with pytest.raises(RefusedError, match="drive_base is not running"):
        robot.nodes.set_parameters(BASE, {"max_speed": 0.3}, robot.now)


# --- facts ---------------------------------------------------------------------------------------


def test_a_node_that_is_asked_says_all_that_it_is_in() -> None:
    robot = robot_with(None)
    robot.bring(BASE, T.CONFIGURE)
    robot.ask_parameters(BASE, {"max_speed": 0.5})
    robot.pass_time(1.0)
    robot.ask_facts(BASE)

    assert [m for _, m in robot.pass_time(0.0)] == [
        NodeReport(
            BASE,
            state=S.INACTIVE,
            parameters={"max_speed": 0.5, "controller": "none"},
            reachable=True,
            has_lifecycle=True,
        )
    ]


def test_a_report_does_not_change_when_the_node_does() -> None:
    robot = RecordedNodes()
    (_, first), _ = robot.pass_time(0.0)
    robot.nodes.set_parameters(BASE, {"max_speed": 0.3}, robot.now)

    assert isinstance(first, NodeReport)
    assert first.parameters == {"max_speed": 0.0, "controller": "none"}


# --- faults --------------------------------------------------------------------------------------


def test_a_slow_node_takes_twenty_times_as_long() -> None:
    robot = robot_with(Fault.SLOW)
    robot.ask(BASE, T.CONFIGURE)
    robot.ask_parameters(BASE, {"max_speed": 0.5})

    said = robot.pass_time(10.0)

    assert states(said) == [(1.0, S.CONFIGURING), (7.0, S.INACTIVE)]
    assert (1.4, NodeReport(BASE, parameters={"max_speed": 0.5})) in said


def test_a_node_that_refuses_says_so_and_stays_as_it_is() -> None:
    robot = robot_with(Fault.REFUSE)
    asked = [robot.ask(BASE, T.CONFIGURE), robot.ask_parameters(BASE, {})]

    assert [m for _, m in robot.pass_time(10.0)] == [
        NodeAnswer(request, BASE, False, "the node rejects it") for request in asked
    ]


@pytest.mark.parametrize("rule", TRANSITIONS, ids=lambda rule: f"{rule.transition}-{rule.start}")
def test_a_callback_that_fails_ends_where_the_table_says(rule: TransitionRule) -> None:
    robot = RecordedNodes()
    robot.bring(BASE, *PATHS_TO[rule.start])
    robot.set_fault(BASE, Fault.FAIL)
    robot.ask(BASE, rule.transition)

    assert [state for _, state in states(robot.pass_time(10.0))] == [rule.via, rule.failure]


def test_an_error_in_the_running_callback_ends_unconfigured_by_way_of_errorprocessing() -> None:
    robot = robot_with(None)
    robot.ask(BASE, T.CONFIGURE)
    robot.pass_time(0.1)
    robot.set_fault(BASE, Fault.ERROR)

    assert states(robot.pass_time(10.0)) == [(1.3, S.ERROR_PROCESSING), (1.8, S.UNCONFIGURED)]


def test_the_next_callback_runs_into_the_error_when_none_is_running() -> None:
    robot = robot_with(Fault.ERROR)

    assert robot.pass_time(10.0) == []

    robot.ask(BASE, T.CONFIGURE)
    assert [state for _, state in states(robot.pass_time(10.0))] == [
        S.CONFIGURING,
        S.ERROR_PROCESSING,
        S.UNCONFIGURED,
    ]


def test_a_node_that_processes_an_error_takes_no_transition() -> None:
    robot = robot_with(Fault.ERROR)
    robot.ask(BASE, T.CONFIGURE)
    robot.pass_time(0.4)
    robot.ask(BASE, T.CONFIGURE)

    assert [answer.reason for answer in answers(robot.pass_time(0.0))] == [
        "the node is errorprocessing: it cannot configure"
    ]


def test_a_silent_node_hears_and_acts_but_says_nothing_and_is_missed_after_three_seconds() -> None:
    robot = robot_with(Fault.SILENT)
    robot.ask(BASE, T.CONFIGURE)
    robot.ask_parameters(BASE, {"max_speed": 0.5})
    robot.ask_facts(BASE)

    assert robot.pass_time(60.0) == [(4.0, NodeReport(BASE, reachable=False))]
    assert robot.nodes.state_of(BASE) is S.INACTIVE
    assert robot.nodes.parameters_of(BASE)["max_speed"] == 0.5


def test_a_silent_node_that_speaks_again_says_what_it_is_in_by_now() -> None:
    robot = robot_with(Fault.SILENT)
    robot.ask(BASE, T.CONFIGURE)
    robot.pass_time(60.0)
    robot.set_fault(BASE, None)

    assert robot.pass_time(0.0) == [
        (
            61.0,
            NodeReport(
                BASE,
                state=S.INACTIVE,
                parameters={"max_speed": 0.0, "controller": "none"},
                reachable=True,
                has_lifecycle=True,
            ),
        )
    ]


class Outage(NamedTuple):
    """Faults of a node, each with how long after the one before, and when it was reachable."""

    faults: tuple[tuple[float, Fault | None], ...]
    told: list[tuple[float, bool]]


@table(
    {
        "silent for a moment: it is not missed": Outage(
            faults=((0.0, Fault.SILENT), (2.9, None)), told=[(3.9, True)]
        ),
        "silent again: it is missed three seconds after that": Outage(
            faults=((0.0, Fault.SILENT), (2.0, None), (0.0, Fault.SILENT)),
            told=[(3.0, True), (6.0, False)],
        ),
        "silent twice at the same time: it is missed once": Outage(
            faults=((0.0, Fault.SILENT), (0.0, None), (0.0, Fault.SILENT)),
            told=[(1.0, True), (4.0, False)],
        ),
        "told twice to be silent: that changes nothing": Outage(
            faults=((0.0, Fault.SILENT), (2.0, Fault.SILENT)), told=[(4.0, False)]
        ),
        "silent, and dead before that is noticed: it is missed once, as dead": Outage(
            faults=((0.0, Fault.SILENT), (0.5, Fault.DIE)), told=[(2.5, False)]
        ),
        "silent, and dead when about to be missed: it is missed once, as silent": Outage(
            faults=((0.0, Fault.SILENT), (2.9, Fault.DIE)), told=[(4.0, False)]
        ),
        "dead a second time: it is missed a second time": Outage(
            faults=((0.0, Fault.DIE), (2.0, None), (0.0, Fault.DIE)),
            told=[(2.0, False), (3.0, True), (4.0, False)],
        ),
    }
)
def test_a_node_is_missed_when_its_silence_or_death_is_noticed(row: Outage) -> None:
    robot = robot_with(None)
    robot.heard.clear()
    for after_s, fault in row.faults:
        robot.pass_time(after_s)
        robot.set_fault(BASE, fault)
    robot.pass_time(60.0)

    assert reachability(robot.heard) == row.told


def test_a_dead_node_loses_what_it_was_at_and_is_missed_after_a_second() -> None:
    robot = robot_with(None)
    robot.ask(BASE, T.CONFIGURE)
    robot.ask_parameters(BASE, {"max_speed": 0.5})
    robot.pass_time(0.01)
    robot.set_fault(BASE, Fault.DIE)

    assert robot.pass_time(60.0) == [(2.01, NodeReport(BASE, reachable=False))]
    assert robot.nodes.state_of(BASE) is S.UNKNOWN
    assert robot.nodes.parameters_of(BASE) == {}


def test_a_dead_node_refuses_only_once_it_is_known_to_be_dead() -> None:
    robot = robot_with(Fault.DIE)
    robot.ask(BASE, T.CONFIGURE)

    assert answers(robot.pass_time(1.0)) == []

    asked = [
        robot.ask(BASE, T.CONFIGURE),
        robot.ask_parameters(BASE, {"max_speed": 0.5}),
        robot.ask_facts(BASE),
    ]
    assert [m for _, m in robot.pass_time(60.0)] == [
        NodeAnswer(request, BASE, False, "not reachable") for request in asked
    ]


def test_a_dead_node_comes_back_as_if_it_had_just_been_started() -> None:
    robot = robot_with(None)
    robot.ask_parameters(BASE, {"max_speed": 0.5})
    robot.bring(BASE, T.CONFIGURE, T.ACTIVATE)
    robot.set_fault(BASE, Fault.DIE)
    robot.pass_time(5.0)
    robot.set_fault(BASE, None)

    assert [m for _, m in robot.pass_time(0.0)] == [
        NodeReport(
            BASE,
            state=S.UNCONFIGURED,
            parameters={"max_speed": 0.0, "controller": "none"},
            reachable=True,
            has_lifecycle=True,
        )
    ]


def test_a_node_that_is_back_at_once_does_not_go_on_with_what_it_was_at() -> None:
    robot = robot_with(None)
    robot.ask(BASE, T.CONFIGURE)
    robot.pass_time(0.1)
    robot.set_fault(BASE, Fault.DIE)
    robot.set_fault(BASE, None)

    assert states(robot.pass_time(60.0)) == [(1.1, S.UNCONFIGURED)]


@pytest.mark.parametrize(("fault", "missed_at"), [(Fault.SILENT, 3.0), (Fault.DIE, 1.0)])
def test_a_node_that_is_missing_from_the_start_is_reported_as_such(
    fault: Fault, missed_at: float
) -> None:
    robot = RecordedNodes({BASE: NodeSettings(fault=fault)})

    said = [(t, m) for t, m in robot.pass_time(60.0) if m.node == BASE]

    assert said == [(missed_at, NodeReport(BASE, reachable=False))]


def test_a_node_that_dies_when_it_is_already_missed_is_not_missed_again() -> None:
    robot = robot_with(Fault.SILENT)
    robot.pass_time(10.0)
    robot.set_fault(BASE, Fault.DIE)

    assert robot.pass_time(60.0) == []


def test_nobody_is_woken_to_notice_a_silence_that_is_over() -> None:
    robot = robot_with(Fault.SILENT)
    robot.set_fault(BASE, None)
    robot.pass_time(0.0)

    assert robot.nodes.wake_at() is None


# --- size ----------------------------------------------------------------------------------------


def test_ten_thousand_nodes_cost_no_more_each_than_a_hundred() -> None:
    def configure_all(number: int) -> float:
        names = [PartName(f"node_{n}") for n in range(number)]
        model = SmhModel({n: NodeModel(n, {DEFAULT_MODE: {"rate": 1.0}}) for n in names}, {})
        robot = RecordedNodes(model=model)
        robot.pass_time(0.0)
        # Else Python looks through all that the tests before left behind, again and again.
        gc.collect()
        gc.disable()
        began = time.process_time()
        for request, name in enumerate(names):
            robot.nodes.handle(AskTransition(request, name, T.CONFIGURE), robot.now)
            robot.pass_time(0.001)
        robot.pass_time(1.0)
        took = time.process_time() - began
        gc.enable()
        return took / number

    few = min(configure_all(100) for _ in range(3))

    # Linear work per step would make this a hundred times as much.
    assert configure_all(10_000) < 10 * few


def test_what_a_node_says_of_its_own_accord_is_due_when_it_happens() -> None:
    """Also when time is told late: each message is as old as what it tells."""
    for fault, ends in ((None, 0.3), (Fault.FAIL, 0.3), (Fault.ERROR, 0.8)):
        robot = robot_with(fault)
        robot.ask(BASE, T.CONFIGURE)
        said = robot.pass_time(9.0)
        assert [t for t, _ in said][-1] == pytest.approx(1.0 + ends)


def test_a_node_that_is_not_there_is_told_with_those_that_are() -> None:
    robot = robot_with(None)
    with pytest.raises(UnknownPartError) as unknown:
        robot.set_fault(NOWHERE, Fault.DIE)
    with pytest.raises(UnknownPartError) as undeclared:
        SimulatedNodes(actuation_model(), {NOWHERE: NodeSettings()}, 0)

    for error in (unknown.value, undeclared.value):
        assert error.message == "there is no node 'nowhere'"
        assert error.hint == "known: drive_base, manipulator"
