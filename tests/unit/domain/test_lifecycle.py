"""The lifecycle table against the ROS 2 design of managed nodes."""

import itertools

import pytest

from domain.lifecycle import (
    PRIMARY_STATES,
    TRANSITIONS,
    LifecycleState,
    Transition,
    TransitionRule,
    arrival,
    is_legal_request,
    path,
    rule_for,
)
from tests.support.tables import text_table

S, T = LifecycleState, Transition

# lifecycle_msgs/msg/State and Transition.
IDS = {
    "unknown": 0,
    "unconfigured": 1,
    "inactive": 2,
    "active": 3,
    "finalized": 4,
    "configuring": 10,
    "cleaningup": 11,
    "shuttingdown": 12,
    "activating": 13,
    "deactivating": 14,
    "errorprocessing": 15,
}

# From, to, and what leads there; shutdown of an active node deactivates it first.
PATHS = {
    ("unconfigured", "unconfigured"): [],
    ("unconfigured", "inactive"): ["configure"],
    ("unconfigured", "active"): ["configure", "activate"],
    ("unconfigured", "finalized"): ["shutdown"],
    ("inactive", "unconfigured"): ["cleanup"],
    ("inactive", "inactive"): [],
    ("inactive", "active"): ["activate"],
    ("inactive", "finalized"): ["shutdown"],
    ("active", "unconfigured"): ["deactivate", "cleanup"],
    ("active", "inactive"): ["deactivate"],
    ("active", "active"): [],
    ("active", "finalized"): ["deactivate", "shutdown"],
    ("finalized", "finalized"): [],
}


def test_labels_and_numbers_are_those_of_ros_2() -> None:
    assert {str(state): state.id for state in LifecycleState} == IDS


def test_a_node_rests_in_four_states() -> None:
    resting = [str(state) for state in LifecycleState if state.is_primary]

    assert resting == ["unconfigured", "inactive", "active", "finalized"]


def test_numbers_of_transitions_are_those_of_ros_2() -> None:
    assert {(str(rule.start), str(rule.transition)): rule.id for rule in TRANSITIONS} == {
        ("unconfigured", "configure"): 1,
        ("inactive", "cleanup"): 2,
        ("inactive", "activate"): 3,
        ("active", "deactivate"): 4,
        ("unconfigured", "shutdown"): 5,
        ("inactive", "shutdown"): 6,
        ("active", "shutdown"): 7,
    }


@pytest.mark.parametrize("rule", TRANSITIONS, ids=lambda rule: f"{rule.start} {rule.transition}")
def test_a_callback_that_fails_leaves_the_node_where_it_was_or_ends_it(
    rule: TransitionRule,
) -> None:
    assert rule.failure in (rule.start, S.FINALIZED)
    assert not rule.via.is_primary


@pytest.mark.parametrize("start", sorted(PRIMARY_STATES))
@pytest.mark.parametrize("goal", sorted(PRIMARY_STATES))
def test_the_way_between_two_states_is_the_shortest_that_is_safe(
    start: LifecycleState, goal: LifecycleState
) -> None:
    expected = PATHS.get((str(start), str(goal)))

    assert path(start, goal) == (None if expected is None else tuple(map(T, expected)))


@pytest.mark.parametrize(
    ("start", "goal"),
    [pair for pair in itertools.product(sorted(PRIMARY_STATES), repeat=2) if path(*pair)],
)
def test_every_step_of_a_way_begins_where_the_one_before_ended(
    start: LifecycleState, goal: LifecycleState
) -> None:
    state = start
    for transition in path(start, goal) or ():
        rule = rule_for(state, transition)
        assert rule is not None
        state = rule.success

    assert state is goal


def test_there_is_no_way_to_or_from_a_state_in_which_nothing_rests() -> None:
    assert path(S.CONFIGURING, S.ACTIVE) is None
    assert path(S.UNKNOWN, S.ACTIVE) is None


@pytest.mark.parametrize(
    ("state", "ends_in"),
    [
        ("configuring", "inactive"),
        ("cleaningup", "unconfigured"),
        ("activating", "active"),
        ("deactivating", "inactive"),
        ("shuttingdown", "finalized"),
        ("errorprocessing", "unconfigured"),
        ("active", "active"),
        ("unknown", "unknown"),
    ],
)
def test_a_node_on_its_way_arrives_when_nothing_goes_wrong(state: str, ends_in: str) -> None:
    assert arrival(S(state)) == ends_in


@text_table("""
    to         | when         | judged
    activate   | unconfigured | legal
    cleanup    | active       | legal
    shutdown   | active       | legal
    deactivate | inactive     | legal
    shutdown   | finalized    | legal
    configure  | active       | illegal
    deactivate | unconfigured | illegal
    activate   | finalized    | illegal
""")
def test_a_request_may_imply_the_steps_before_it_and_never_a_step_back(
    to: str, when: str, judged: str
) -> None:
    assert is_legal_request(T(to), S(when)) is (judged == "legal")


def test_what_is_met_already_is_legal() -> None:
    for transition in Transition:
        assert is_legal_request(transition, transition.goal)


def test_a_request_is_legal_only_where_a_way_leads_to_its_goal() -> None:
    for transition, state in itertools.product(Transition, LifecycleState):
        if is_legal_request(transition, state):
            assert path(state, transition.goal) is not None
