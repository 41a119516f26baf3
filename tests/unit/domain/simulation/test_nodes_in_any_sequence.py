"""What holds of simulated nodes whatever is asked of them, whatever fails, and whenever."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TypeAlias

from hypothesis import given
from hypothesis import strategies as st

from domain.commands import AskFacts, AskParameters, AskTransition
from domain.errors import PilothouseError
from domain.inputs import NodeAnswer, NodeReport
from domain.lifecycle import ERROR_PROCESSED, TRANSITIONS, LifecycleState, Transition
from domain.parameters import Parameters
from domain.simulation.node_settings import Fault, NodeSettings
from domain.simulation.nodes import NodeMessage, SimulatedNodes
from domain.state_and_mode import PartName
from domain.timebase import Duration, Instant, seconds
from tests.support.models import ARM, BASE, actuation_model


@dataclass(frozen=True)
class Outside:
    """Somebody else sets these."""

    values: Parameters


Act: TypeAlias = Transition | Fault | Parameters | Outside | str | None
S = LifecycleState


@dataclass(frozen=True)
class Step:
    """After `pause`, somebody does something to `node`."""

    pause: Duration
    node: PartName
    act: Act


# Short steps, so that they meet work that is under way, and at times its very end.
PAUSES = st.sampled_from([0, 0, 0.01, 0.02, 0.1, 0.2, 0.3, 0.5, 1.0, 3.0]).map(seconds)
PARAMETERS: st.SearchStrategy[Parameters] = st.sampled_from(
    [{"max_speed": 0.5}, {"max_speed": 0.1, "controller": "PID"}, {"max_speed": 1}, {"wheels": 4.0}]
)
TRANSITION_ACTS = st.sampled_from(Transition)


def steps(acts: st.SearchStrategy[Act]) -> st.SearchStrategy[list[Step]]:
    """Return sequences of up to 40 things that somebody does to a node."""
    nodes = st.sampled_from([BASE, ARM])
    return st.lists(st.builds(Step, PAUSES, nodes, acts), max_size=40)


ANYTHING = steps(
    st.one_of(
        TRANSITION_ACTS,
        st.sampled_from(Fault),
        st.none(),
        PARAMETERS,
        PARAMETERS.map(Outside),
        st.just("say your facts"),
    )
)
WITHOUT_LOSS = steps(
    st.one_of(
        TRANSITION_ACTS,
        st.sampled_from([Fault.SLOW, Fault.REFUSE, Fault.FAIL, Fault.ERROR, None]),
        PARAMETERS,
    )
)
SETTINGS = st.sampled_from(
    [
        {},
        {BASE: NodeSettings(fault=Fault.SILENT)},
        {BASE: NodeSettings(fault=Fault.DIE), ARM: NodeSettings(plain=True)},
        {BASE: NodeSettings(configure=0, set_parameters=0, process_error=0)},
    ]
)


def do(nodes: SimulatedNodes, request: int, step: Step, now: Instant) -> None:
    """Carry out one step."""
    match step.act:
        case Transition() as transition:
            nodes.handle(AskTransition(request, step.node, transition), now)
        case Fault() | None as fault:
            nodes.set_fault(step.node, fault, now)
        case Outside(values):
            # What it would not take, or has no process for, changes nothing.
            with suppress(PilothouseError):
                nodes.set_parameters(step.node, values, now)
        case dict() as values:
            nodes.handle(AskParameters(request, step.node, values), now)
        case _:
            nodes.handle(AskFacts(request, step.node), now)


Advance: TypeAlias = Callable[[SimulatedNodes, Instant, Instant], Sequence[NodeMessage]]


def play(
    script: list[Step], settings: dict[PartName, NodeSettings], advance: Advance
) -> list[NodeMessage]:
    """Return what is said when `advance` leads the nodes from each step to the next one."""
    now = seconds(7.0)
    nodes = SimulatedNodes(actuation_model(), settings, now)
    said: list[NodeMessage] = []
    for request, step in enumerate(script):
        said.extend(advance(nodes, now, now + step.pause))
        now += step.pause
        do(nodes, request, step, now)
    said.extend(advance(nodes, now, now + seconds(20.0)))
    said.extend(nodes.advance(now + seconds(20.0)))
    return said


def not_at_all(nodes: SimulatedNodes, start: Instant, end: Instant) -> Sequence[NodeMessage]:
    return ()


def when_it_wants(nodes: SimulatedNodes, start: Instant, end: Instant) -> Sequence[NodeMessage]:
    said: list[NodeMessage] = []
    while (at := nodes.wake_at()) is not None and at <= end:
        assert at >= start, "it wants to have been woken in the past"
        said.extend(nodes.advance(at))
        later = nodes.wake_at()
        assert later is None or later > at, "it wants to be woken for what it has just done"
    return said


def in_small_steps(nodes: SimulatedNodes, start: Instant, end: Instant) -> Sequence[NodeMessage]:
    # 7 ms: no work takes a multiple of it, so that no step hits an end.
    times = [*range(start, end, seconds(0.007)), end]
    return [message for at in times for message in nodes.advance(at)]


@given(ANYTHING, SETTINGS)
def test_it_does_not_matter_in_which_steps_time_passes(
    script: list[Step], settings: dict[PartName, NodeSettings]
) -> None:
    at_its_own_times = play(script, settings, when_it_wants)

    assert play(script, settings, not_at_all) == at_its_own_times
    assert play(script, settings, in_small_steps) == at_its_own_times
    assert play(script, settings, when_it_wants) == at_its_own_times, "the same once more"


LEGAL = {
    *((rule.start, rule.via) for rule in TRANSITIONS),
    *((rule.via, end) for rule in TRANSITIONS for end in (rule.success, rule.failure)),
    *((rule.via, S.ERROR_PROCESSING) for rule in TRANSITIONS),
    (S.ERROR_PROCESSING, ERROR_PROCESSED),
}
VIA = {rule.via for rule in TRANSITIONS}


@given(WITHOUT_LOSS)
def test_a_node_moves_only_along_the_lifecycle_table(script: list[Step]) -> None:
    at = dict.fromkeys((BASE, ARM), S.UNCONFIGURED)
    for message in play(script, {}, when_it_wants)[2:]:
        if isinstance(message, NodeReport) and message.state is not None:
            assert (at[message.node], message.state) in LEGAL
            at[message.node] = message.state


@given(WITHOUT_LOSS)
def test_a_node_begins_one_callback_for_each_transition_it_takes_and_one_at_a_time(
    script: list[Step],
) -> None:
    busy = dict.fromkeys((BASE, ARM), False)
    begun = taken = 0
    for message in play(script, {}, when_it_wants)[2:]:
        if isinstance(message, NodeAnswer):
            asked = script[message.request]
            if isinstance(asked.act, Transition) and message.accepted:
                assert not busy[asked.node]
                taken += 1
        elif message.state is not None:
            begun += message.state in VIA
            busy[message.node] = not message.state.is_primary

    assert begun == taken


@given(WITHOUT_LOSS)
def test_every_request_of_a_node_that_is_heard_is_answered_once(script: list[Step]) -> None:
    answered = [m.request for m in play(script, {}, when_it_wants) if isinstance(m, NodeAnswer)]
    asked = [n for n, step in enumerate(script) if isinstance(step.act, Transition | dict)]

    assert sorted(answered) == asked


@given(ANYTHING, SETTINGS)
def test_a_node_is_always_in_a_state_of_the_table_and_what_was_heard_last_is_true(
    script: list[Step], settings: dict[PartName, NodeSettings]
) -> None:
    now = 0
    nodes = SimulatedNodes(actuation_model(), settings, now)
    told: dict[PartName, LifecycleState] = {}
    mute = {name for name, own in settings.items() if own.fault in {Fault.SILENT, Fault.DIE}}
    plain = {name for name, own in settings.items() if own.plain}

    def listen() -> None:
        for message in nodes.advance(now):
            if isinstance(message, NodeReport) and message.state is not None:
                told[message.node] = message.state

    for request, step in enumerate(script):
        now += step.pause
        listen()
        do(nodes, request, step, now)
        listen()
        if isinstance(step.act, Fault) or step.act is None:
            is_mute = step.act in {Fault.SILENT, Fault.DIE}
            (mute.add if is_mute else mute.discard)(step.node)
        for name in (BASE, ARM):
            state = nodes.state_of(name)
            assert state in VIA or state.is_primary or state in {S.ERROR_PROCESSING, S.UNKNOWN}
            if name not in mute | plain:
                assert told[name] is state
