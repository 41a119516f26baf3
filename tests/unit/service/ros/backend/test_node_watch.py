from collections.abc import AsyncIterator

import pytest

from domain.inputs import NodeAnswer, NodeReport
from domain.lifecycle import LifecycleState, Transition
from service.ros.backend.node_watch import MOST_COMMANDS
from tests.support.heard_nodes import START_PARAMETERS, HeardNodes, all_facts, heard_nodes
from tests.support.models import BASE
from tests.support.ros_graph import LATENCY_S
from tests.support.ros_nodes import Outcome, parameter_event

S, T = LifecycleState, Transition
GONE = NodeReport(BASE, reachable=False)
PARAMETER_SERVICES = ("get_parameters", "set_parameters_atomically")


@pytest.fixture
async def robot() -> AsyncIterator[HeardNodes]:
    async with heard_nodes() as heard:
        yield heard


# --- a node appears ------------------------------------------------------------------------------


async def test_a_node_that_never_came_is_reported_as_unreachable_once(robot: HeardNodes) -> None:
    await robot.listen()
    await robot.advance(30.0)

    assert robot.reports() == [GONE]
    assert robot.requests("get_state") == []


async def test_a_node_that_is_there_says_everything_in_one_report(robot: HeardNodes) -> None:
    robot.base()
    await robot.listen()
    await robot.advance(0.1)

    assert robot.reports() == [GONE, all_facts(S.UNCONFIGURED)]


async def test_a_node_that_starts_later_is_found_within_a_second(robot: HeardNodes) -> None:
    await robot.listen()
    await robot.advance(7.3)
    robot.base().move(T.CONFIGURE)
    await robot.advance(1.0)

    assert robot.reports()[-1] == all_facts(S.INACTIVE)


async def test_a_node_whose_services_are_found_one_by_one_is_asked_when_all_are(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    for service in PARAMETER_SERVICES:
        robot.graph.withdraw(f"/{BASE}/{service}")
    await robot.listen()
    await robot.advance(0.5)
    base.start()
    await robot.advance(1.0)

    assert robot.reports() == [GONE, all_facts(S.UNCONFIGURED)]


async def test_a_node_without_services_of_parameters_is_known_by_its_state(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    for service in PARAMETER_SERVICES:
        robot.graph.withdraw(f"/{BASE}/{service}")
    await robot.listen()
    await robot.advance(1.5)
    known = robot.reports()[1:]
    base.start()
    await robot.advance(1.0)

    assert known == [NodeReport(BASE, S.UNCONFIGURED, reachable=True, has_lifecycle=True)]
    assert robot.reports()[2:] == [all_facts(S.UNCONFIGURED)]


async def test_a_node_without_lifecycle_is_known_by_its_parameters_after_a_second(
    robot: HeardNodes,
) -> None:
    robot.base(plain=True)
    await robot.listen()
    await robot.advance(0.9)
    early = robot.reports()
    await robot.advance(0.2)

    assert early == [GONE]
    assert robot.reports() == [GONE, all_facts(None, lifecycle=False)]


async def test_a_lifecycle_that_is_found_late_is_one_after_all(robot: HeardNodes) -> None:
    plain = robot.base(plain=True)
    await robot.join()
    plain.kill()
    robot.base()
    await robot.advance(1.0)

    assert robot.reports() == [all_facts(S.UNCONFIGURED)]


async def test_an_answer_that_was_overtaken_by_an_event_is_not_believed(robot: HeardNodes) -> None:
    base = robot.base()
    await robot.listen()
    # After the node said what it is in, and before it said what it has set.
    await robot.advance(2.5 * LATENCY_S)
    base.move(T.CONFIGURE)
    await robot.advance(0.1)

    assert robot.reports() == [GONE, all_facts(S.INACTIVE)]


async def test_a_parameter_that_is_set_while_it_is_asked_for_is_the_new_one(
    robot: HeardNodes,
) -> None:
    robot.base()
    await robot.listen()
    # The answer is on its way.
    await robot.advance(3.5 * LATENCY_S)
    robot.graph.publish("/parameter_events", parameter_event(BASE, {"max_speed": 0.7}))
    await robot.advance(0.1)

    assert robot.reports()[-1] == all_facts(S.UNCONFIGURED, {**START_PARAMETERS, "max_speed": 0.7})


async def test_a_node_that_moves_while_it_is_asked_is_asked_until_it_rests(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    await robot.listen()
    # To be asked for everything takes two requests and two responses.
    await robot.advance(2 * LATENCY_S)
    for transition in (T.CONFIGURE, T.ACTIVATE, T.DEACTIVATE):
        base.move(transition)
        await robot.advance(4 * LATENCY_S)
    moving = robot.reports()
    await robot.advance(1.0)

    assert moving == [GONE]
    assert robot.reports() == [GONE, all_facts(S.INACTIVE)]


async def test_a_parameter_is_heard_of_a_node_that_cannot_be_asked_for_any(
    robot: HeardNodes,
) -> None:
    robot.base()
    robot.graph.withdraw(f"/{BASE}/get_parameters")
    await robot.join()
    robot.set(1, {"max_speed": 0.3})
    await robot.advance(0.4)

    assert robot.answers() == [NodeAnswer(1, BASE, True)]
    assert robot.reports() == [NodeReport(BASE, parameters={"max_speed": 0.3})]
    await robot.advance(0.2)
    assert robot.states() == [None, S.UNCONFIGURED]


async def test_a_parameter_that_is_not_declared_hides_no_other(robot: HeardNodes) -> None:
    base = robot.base()
    del base.parameters["controller"]
    await robot.listen()
    await robot.advance(0.1)

    assert robot.reports()[-1] == all_facts(S.UNCONFIGURED, {"max_speed": 0.0})


# --- a node falls silent -------------------------------------------------------------------------


@pytest.mark.parametrize("died_at_s", [0.0, 0.0025, 0.1, 0.5, 0.9, 0.99])
async def test_a_node_that_dies_is_missed_within_three_seconds(
    robot: HeardNodes, died_at_s: float
) -> None:
    base = robot.base()
    await robot.listen()
    await robot.advance(5.0 + died_at_s)
    robot.heard.clear()
    since_s = robot.now_s
    base.kill()
    await robot.advance(10.0)

    after_s = robot.unreachable_after_s(since_s)
    assert after_s is not None
    assert after_s <= 2.81
    assert robot.reports() == [GONE]


async def test_one_answer_that_does_not_come_makes_no_node_unreachable(robot: HeardNodes) -> None:
    base = robot.base()
    await robot.join()
    for _ in range(3):
        base.stop()
        await robot.advance(1.4)
        base.go_on()
        await robot.advance(1.6)

    assert robot.reports() == []


async def test_with_a_heartbeat_a_node_that_dies_is_missed_within_a_second(
    robot: HeardNodes,
) -> None:
    base = robot.base(heartbeat=True)
    await robot.join()
    since_s = robot.now_s
    base.kill()
    await robot.advance(10.0)

    assert robot.unreachable_after_s(since_s) == pytest.approx(0.5)
    assert robot.reports() == [GONE]


async def test_a_node_with_a_heartbeat_is_seldom_asked(robot: HeardNodes) -> None:
    robot.base(heartbeat=True)
    await robot.join()
    since_s = robot.now_s
    await robot.advance(20.0)

    assert len(robot.requests("get_state", since_s)) == 4


async def test_a_node_that_hangs_though_its_process_lives_is_missed(robot: HeardNodes) -> None:
    base = robot.base(heartbeat=True)
    await robot.join()
    base.hang()
    await robot.advance(10.0)

    assert robot.reports() == [GONE]


async def test_a_long_callback_makes_a_node_with_a_heartbeat_not_unreachable(
    robot: HeardNodes,
) -> None:
    base = robot.base(heartbeat=True)
    base.takes_s = 8.0
    await robot.join()
    robot.ask(1, T.CONFIGURE)
    await robot.advance(10.0)

    assert robot.reports() == [NodeReport(BASE, S.CONFIGURING), NodeReport(BASE, S.INACTIVE)]


async def test_a_long_callback_makes_another_node_unreachable_until_it_has_ended(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    base.takes_s = 8.0
    await robot.join()
    robot.ask(1, T.CONFIGURE)
    await robot.advance(10.0)

    assert robot.reports() == [NodeReport(BASE, S.CONFIGURING), GONE, all_facts(S.INACTIVE)]


async def test_a_dead_node_that_is_back_says_everything_in_one_report(robot: HeardNodes) -> None:
    base = robot.base()
    await robot.join()
    robot.ask(1, T.CONFIGURE)
    await robot.advance(1.0)
    base.kill()
    await robot.advance(3.0)
    robot.heard.clear()
    base.start()
    await robot.advance(1.0)

    assert robot.reports() == [all_facts(S.UNCONFIGURED)]


# --- what gets lost ------------------------------------------------------------------------------


async def test_a_transition_that_was_not_heard_is_noticed_within_a_second(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    await robot.join()
    base.loses_events = True
    base.move(T.CONFIGURE)
    await robot.advance(1.0)

    assert robot.reports() == [all_facts(S.INACTIVE)]


async def test_parameters_that_the_node_never_heard_of_are_asked_for_again(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    await robot.join()
    base.misses = 1
    robot.set(1, {"max_speed": 0.5})
    await robot.advance(0.8)

    assert robot.answers() == [NodeAnswer(1, BASE, True)]
    assert base.parameters["max_speed"] == 0.5


async def test_a_transition_that_the_node_never_heard_of_is_asked_for_again(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    await robot.join()
    base.misses = 1
    robot.ask(1, T.CONFIGURE)
    await robot.advance(0.8)

    assert robot.answers() == [NodeAnswer(1, BASE, True)]
    assert base.state is S.INACTIVE


async def test_to_activate_is_never_asked_twice_since_an_estop_may_have_come(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    await robot.join()
    base.move(T.CONFIGURE)
    await robot.advance(0.2)
    base.misses = 1
    robot.ask(1, T.ACTIVATE)
    await robot.advance(10.0)

    assert len(robot.requests("change_state")) == 1
    assert base.state is S.INACTIVE


async def test_older_parameters_are_not_set_again_after_newer_ones(robot: HeardNodes) -> None:
    base = robot.base()
    await robot.join()
    base.misses = 1
    robot.set(1, {"max_speed": 0.5})
    await robot.advance(0.3)
    robot.set(2, {"max_speed": 0.9})
    await robot.advance(10.0)

    assert len(robot.requests("set_parameters_atomically")) == 2
    assert base.parameters["max_speed"] == 0.9


async def test_a_transition_whose_answer_and_events_got_lost_is_seen_to_be_done(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    await robot.join()
    base.loses_answers = base.loses_events = True
    robot.ask(1, T.CONFIGURE)
    await robot.advance(0.1)
    base.loses_answers = base.loses_events = False
    await robot.advance(0.9)

    assert robot.answers() == [NodeAnswer(1, BASE, True)]
    assert robot.reports()[-1].state is S.INACTIVE


async def test_a_restart_that_was_too_quick_to_be_missed_is_noticed(robot: HeardNodes) -> None:
    base = robot.base()
    await robot.join()
    base.move(T.CONFIGURE)
    base.set({"max_speed": 0.5})
    await robot.advance(1.0)
    robot.heard.clear()
    base.start()
    await robot.advance(1.0)

    assert robot.reports() == [all_facts(S.UNCONFIGURED)]


async def test_a_new_heartbeat_tells_at_once_of_a_restart_that_was_too_quick(
    robot: HeardNodes,
) -> None:
    base = robot.base(heartbeat=True)
    await robot.join()
    base.move(T.CONFIGURE)
    await robot.advance(1.0)
    robot.heard.clear()
    base.start()
    await robot.advance(0.1)

    assert robot.reports() == [all_facts(S.UNCONFIGURED)]


async def test_parameters_are_not_those_of_before_a_restart_that_was_too_quick(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    await robot.join()
    base.set({"max_speed": 0.5})
    await robot.advance(1.0)
    robot.heard.clear()
    base.start()
    await robot.advance(1.0)

    assert robot.reports() == [all_facts(S.UNCONFIGURED)]


async def test_an_event_that_does_not_follow_from_what_is_known_is_not_believed(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    await robot.join()
    base.loses_events = True
    base.move(T.CONFIGURE)
    base.loses_events = False
    base.move(T.ACTIVATE)
    await robot.advance(0.1)

    assert robot.reports() == [all_facts(S.ACTIVE)]


async def test_a_parameter_of_a_plain_node_that_was_not_heard_is_noticed(robot: HeardNodes) -> None:
    base = robot.base(plain=True)
    await robot.join()
    base.loses_events = True
    base.set({"max_speed": 0.3})
    await robot.advance(1.0)

    values = {**START_PARAMETERS, "max_speed": 0.3}
    assert robot.reports() == [all_facts(None, values, lifecycle=False)]
    robot.heard.clear()
    await robot.advance(5.0)
    assert robot.reports() == []


# --- transitions ---------------------------------------------------------------------------------


async def test_a_transition_is_accepted_when_it_begins_and_reported_at_its_end(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    base.takes_s = 0.5
    await robot.join()
    robot.ask(1, T.CONFIGURE)
    await robot.advance(0.1)
    begun = [message for _, message in robot.heard]
    await robot.advance(5.0)

    assert begun == [NodeAnswer(1, BASE, True), NodeReport(BASE, S.CONFIGURING)]
    assert [message for _, message in robot.heard] == [*begun, NodeReport(BASE, S.INACTIVE)]


async def test_shutdown_is_asked_for_from_wherever_the_node_is(robot: HeardNodes) -> None:
    robot.base().move(T.CONFIGURE)
    await robot.join()
    robot.ask(1, T.SHUTDOWN)
    await robot.advance(0.1)

    assert robot.states() == [S.SHUTTING_DOWN, S.FINALIZED]
    assert robot.graph.requests[-1].fields == {"transition": {"id": 6, "label": "shutdown"}}


async def test_a_transition_of_which_nothing_was_heard_is_asked_for_after_its_answer(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    await robot.join()
    base.loses_events = True
    robot.ask(1, T.CONFIGURE)
    await robot.advance(0.3)

    assert robot.answers() == [NodeAnswer(1, BASE, True)]
    assert robot.reports() == [all_facts(S.INACTIVE)]


async def test_the_end_of_a_transition_that_was_not_heard_is_asked_for(robot: HeardNodes) -> None:
    base = robot.base()
    base.takes_s = 0.05
    await robot.join()
    robot.ask(1, T.CONFIGURE)
    await robot.advance(0.04)
    base.loses_events = True
    await robot.advance(0.3)

    assert robot.reports() == [NodeReport(BASE, S.CONFIGURING), all_facts(S.INACTIVE)]


async def test_a_step_that_follows_at_once_is_not_disturbed(robot: HeardNodes) -> None:
    base = robot.base()
    await robot.join()
    robot.ask(1, T.CONFIGURE)
    await robot.advance(0.05)
    base.takes_s = 0.5
    robot.ask(2, T.ACTIVATE)
    await robot.advance(2.0)

    assert robot.states() == [S.CONFIGURING, S.INACTIVE, S.ACTIVATING, S.ACTIVE]


async def test_a_callback_that_fails_is_seen_to_go_back(robot: HeardNodes) -> None:
    base = robot.base()
    base.outcome = Outcome.FAILURE
    await robot.join()
    robot.ask(1, T.CONFIGURE)
    await robot.advance(1.5)

    assert robot.answers() == [NodeAnswer(1, BASE, True)]
    assert robot.states() == [S.CONFIGURING, S.UNCONFIGURED]


async def test_a_callback_that_fails_unseen_is_told_by_the_answer(robot: HeardNodes) -> None:
    base = robot.base()
    base.outcome, base.loses_events = Outcome.FAILURE, True
    await robot.join()
    robot.ask(1, T.CONFIGURE)
    await robot.advance(0.1)

    reason = "the node tried to configure and went back"
    assert robot.answers() == [NodeAnswer(1, BASE, False, reason)]


async def test_an_error_in_a_callback_is_seen(robot: HeardNodes) -> None:
    base = robot.base()
    base.outcome = Outcome.ERROR
    await robot.join()
    robot.ask(1, T.CONFIGURE)
    await robot.advance(1.5)

    assert robot.states() == [S.CONFIGURING, S.ERROR_PROCESSING, S.UNCONFIGURED]


async def test_a_transition_that_is_not_to_be_had_is_refused_with_what_is(
    robot: HeardNodes,
) -> None:
    robot.base().move(T.CONFIGURE)
    await robot.join()
    robot.ask(1, T.CONFIGURE)
    await robot.advance(0.1)

    reason = "the node rejected configure; it offers cleanup, activate, shutdown"
    assert robot.answers() == [NodeAnswer(1, BASE, False, reason)]


async def test_a_node_that_refuses_and_says_nothing_more_refuses(robot: HeardNodes) -> None:
    robot.base().refuses = True
    await robot.join()
    robot.graph.withdraw(f"/{BASE}/get_available_transitions")
    robot.ask(1, T.CONFIGURE)
    await robot.advance(1.0)

    assert robot.answers() == [NodeAnswer(1, BASE, False, "the node rejected configure")]


async def test_a_node_that_died_gives_no_answer_and_then_is_not_asked_any_more(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    await robot.join()
    base.kill()
    robot.ask(1, T.CONFIGURE)
    await robot.advance(3.0)
    robot.ask(2, T.CONFIGURE)
    await robot.advance(100.0)

    assert robot.answers() == [NodeAnswer(2, BASE, False, "not reachable")]
    assert len(robot.requests("change_state")) == 1


async def test_a_plain_node_takes_no_transition(robot: HeardNodes) -> None:
    robot.base(plain=True)
    await robot.join()
    robot.ask(1, T.CONFIGURE)

    assert robot.answers() == [NodeAnswer(1, BASE, False, "the node has no lifecycle")]


async def test_a_node_that_does_not_answer_is_not_told_more_and_more(robot: HeardNodes) -> None:
    base = robot.base()
    await robot.join()
    base.stop()
    for request in range(MOST_COMMANDS + 1):
        robot.ask(request, T.CONFIGURE)

    reason = f"{MOST_COMMANDS} commands already wait for an answer"
    assert robot.answers() == [NodeAnswer(MOST_COMMANDS, BASE, False, reason)]


# --- parameters ----------------------------------------------------------------------------------


async def test_parameters_are_accepted_and_reported_as_they_are_heard(robot: HeardNodes) -> None:
    robot.base()
    await robot.join()
    robot.set(1, {"max_speed": 0.9})
    await robot.advance(2.0)

    assert robot.answers() == [NodeAnswer(1, BASE, True)]
    assert robot.reports() == [NodeReport(BASE, parameters={"max_speed": 0.9})]


async def test_parameters_are_not_confused_with_a_transition_of_the_same_moment(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    await robot.join()
    robot.set(1, {"max_speed": 1})
    base.move(T.CONFIGURE)
    await robot.advance(1.0)

    assert [answer.accepted for answer in robot.answers()] == [False]
    assert robot.states() == [S.CONFIGURING, S.INACTIVE]


async def test_parameters_of_which_nothing_was_heard_are_asked_for(robot: HeardNodes) -> None:
    base = robot.base()
    await robot.join()
    base.loses_events = True
    robot.set(1, {"max_speed": 0.9})
    await robot.advance(0.6)

    assert robot.reports() == [all_facts(S.UNCONFIGURED, {**START_PARAMETERS, "max_speed": 0.9})]


async def test_a_parameter_that_no_mode_sets_is_asked_for_once_it_was_set(
    robot: HeardNodes,
) -> None:
    base = robot.base()
    base.set({"rate": 5})
    await robot.join()
    base.loses_events = True
    robot.set(1, {"rate": 20})
    await robot.advance(0.6)

    assert robot.reports() == [all_facts(S.UNCONFIGURED, {**START_PARAMETERS, "rate": 20})]


async def test_a_value_of_another_type_is_refused_by_the_node(robot: HeardNodes) -> None:
    robot.base()
    await robot.join()
    robot.set(1, {"max_speed": 1})
    await robot.advance(1.0)

    reason = "max_speed is of type double, not integer"
    assert robot.answers() == [NodeAnswer(1, BASE, False, reason)]
    assert robot.reports() == []


async def test_a_value_that_ros_cannot_carry_is_refused_before_it_is_sent(
    robot: HeardNodes,
) -> None:
    robot.base().set({"rate": 5})
    await robot.join()
    robot.set(1, {"rate": 2**63})
    await robot.advance(1.0)

    (answer,) = robot.answers()
    assert not answer.accepted
    assert answer.reason
    assert robot.requests("set_parameters_atomically") == []


async def test_a_silent_node_says_nothing_about_parameters(robot: HeardNodes) -> None:
    base = robot.base()
    await robot.join()
    base.stop()
    robot.set(1, {"max_speed": 0.9})
    await robot.advance(100.0)

    assert robot.answers() == []


# --- facts ---------------------------------------------------------------------------------------


async def test_a_node_that_is_asked_says_everything(robot: HeardNodes) -> None:
    robot.base()
    await robot.join()
    robot.ask_facts()
    await robot.advance(0.1)

    assert robot.reports() == [all_facts(S.UNCONFIGURED)]


async def test_a_node_that_is_asked_while_it_is_looked_after_says_everything(
    robot: HeardNodes,
) -> None:
    robot.base()
    await robot.listen()
    await robot.advance(5.0)
    robot.heard.clear()
    await robot.advance(LATENCY_S)
    robot.ask_facts()
    await robot.advance(0.1)

    assert robot.reports() == [all_facts(S.UNCONFIGURED)]
