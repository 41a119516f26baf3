"""Whenever the service is restarted, nothing is activated or set before an operator asks for it.

`make soak` plays 10,000 stories, `make test` 300.
"""

import os
from contextlib import suppress

import hypothesis.strategies as st
from hypothesis import given, settings

from domain.changes.settings import ChangeSettings
from domain.commands import AskParameters, AskTransition
from domain.errors import PilothouseError
from domain.inputs import (
    BackendStatus,
    ChangeRequest,
    Input,
    ModeRequest,
    NodeReport,
    ParametersRequest,
    Reading,
    Readings,
    ServiceStall,
    TimePassed,
    TransitionRequest,
)
from domain.kept import KeptChange, KeptTarget
from domain.lifecycle import LifecycleState, Transition
from domain.outbox import Outputs
from domain.parts.system_model import SmhModel
from domain.snapshot import ChangeStatus
from domain.state_and_mode import PartName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import Instant, seconds
from tests.support.good import GOOD
from tests.support.kept_values import KeptValues
from tests.support.models import BASE, nested_model

STORIES = 10_000 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 300
MODEL = nested_model()
STATES = st.none() | st.sampled_from(LifecycleState)
REPORTS = st.builds(
    NodeReport,
    st.sampled_from(list(MODEL.nodes)),
    state=STATES,
    reachable=st.sampled_from([None, True, True, False]),
    has_lifecycle=st.sampled_from([None, None, True, False]),
)
PARTS = st.sampled_from(MODEL.parts)
REQUESTS: st.SearchStrategy[ChangeRequest] = st.one_of(
    PARTS.flatmap(lambda p: st.builds(ModeRequest, st.just(p), st.sampled_from(MODEL.modes_of(p)))),
    st.builds(TransitionRequest, PARTS, st.sampled_from(Transition)),
    st.builds(ParametersRequest, st.just(BASE), st.just({"max_speed": 0.5})),
)
NOT_BY_AN_OPERATOR: st.SearchStrategy[Input] = st.one_of(
    REPORTS,
    REPORTS,
    st.just(TimePassed()),
    st.just(ServiceStall(seconds(1))),
    st.builds(BackendStatus, st.booleans()),
    st.booleans().map(
        lambda good: Readings(
            tuple(Reading(n, v) for n, v in {**GOOD, "estop": not good}.items()), "test"
        )
    ),
)
WAITS = st.sampled_from([0.0, 0.01, 0.5, 3.0, 12.0])


class Robot:
    """A core that is restarted now and then, with its nodes all restored when they reappear."""

    def __init__(self, model: SmhModel) -> None:
        self.model = model
        self.now: Instant = 0
        self.kept = KeptValues()
        self.told: list[int] = []
        self.changes = 0
        self.boot = 0
        self.start()

    def start(self) -> Outputs:
        """Start the service, for the first time or again."""
        changes = ChangeSettings(restored_nodes=frozenset(self.model.nodes))
        self.core = Supervision(self.model, SupervisionSettings(changes=changes), self.now)
        self.boot += 1
        first = self.told[-1] + 1 if self.told else 1
        return self._give(self.kept.restored(self.boot, first, self.changes + 1))

    def give(self, given_: Input, after_s: float = 0.0) -> Outputs:
        """Give an input that may be rejected."""
        self.now += seconds(after_s)
        with suppress(PilothouseError):
            return self._give(given_)
        return self._give(TimePassed())

    def _give(self, given_: Input) -> Outputs:
        outputs = self.kept.take(self.core.handle(given_, self.now))
        self.told += [event.id for event in outputs.events]
        self.changes += sum(event.kind == "change.requested" for event in outputs.events)
        self.changes += sum(event.kind == "node.restoring" for event in outputs.events)
        return outputs


def asked_of(outputs: Outputs) -> set[PartName]:
    """Return the nodes of which more is asked than what they are in."""
    return {c.node for c in outputs.commands if isinstance(c, AskTransition | AskParameters)}


def meant(part: PartName) -> set[PartName]:
    """Return the nodes that a request of a part is about, in any of its modes."""
    return {node for node in MODEL.nodes if part in (node, *MODEL.ancestors[node])}


@settings(max_examples=STORIES, deadline=None)
@given(
    st.lists(st.tuples(WAITS, REQUESTS | NOT_BY_AN_OPERATOR), max_size=12),
    st.lists(st.tuples(WAITS, NOT_BY_AN_OPERATOR), max_size=12),
    REQUESTS,
    st.lists(st.tuples(WAITS, NOT_BY_AN_OPERATOR), max_size=12),
)
def test_nothing_is_asked_of_a_node_before_an_operator_asks_for_it(
    before: list[tuple[float, Input]],
    silence: list[tuple[float, Input]],
    request: ChangeRequest,
    after: list[tuple[float, Input]],
) -> None:
    robot = Robot(MODEL)
    for after_s, given_ in before:
        robot.give(given_, after_s)
    running = [c.id for c in robot.core.changes() if c.status is ChangeStatus.RUNNING]

    assert asked_of(robot.start()) == set()
    for after_s, given_ in silence:
        assert asked_of(robot.give(given_, after_s)) == set()
    assert {c.id: c.reason for c in robot.core.changes()} == dict.fromkeys(running, "restart")
    assert all(robot.core.change(change).status is ChangeStatus.FAILED for change in running)

    part = request.node if isinstance(request, ParametersRequest) else request.part
    allowed = meant(part)
    assert asked_of(robot.give(request)) <= allowed
    for after_s, given_ in after:
        assert asked_of(robot.give(given_, after_s)) <= allowed


@settings(max_examples=STORIES, deadline=None)
@given(
    st.lists(
        st.lists(st.tuples(WAITS, REQUESTS | NOT_BY_AN_OPERATOR), max_size=8),
        min_size=2,
        max_size=4,
    )
)
def test_ids_go_on_and_little_is_kept_however_often_the_service_starts(
    runs: list[list[tuple[float, Input]]],
) -> None:
    robot = Robot(MODEL)
    for run in runs:
        for after_s, given_ in run:
            robot.give(given_, after_s)
            kept = [v.id for v in robot.kept.of(KeptChange) if isinstance(v, KeptChange)]
            running = [c.id for c in robot.core.changes() if c.status is ChangeStatus.RUNNING]
            assert sorted(kept) == sorted(running)
        targets = [robot.core.part(part).target for part in MODEL.parts]
        assert len(robot.kept.of(KeptTarget)) <= sum(target is not None for target in targets)
        robot.start()
        assert [robot.core.part(part).target for part in MODEL.parts] == targets

    assert robot.told == sorted(set(robot.told))
