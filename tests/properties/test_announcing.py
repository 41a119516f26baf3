"""Random runs of two robots: one is silenced now and then, and nothing else differs.

`make soak` tells 10,000 stories, `make test` 60.
"""

import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

import hypothesis.strategies as st
from hypothesis import HealthCheck, given, settings

from domain.conditions.condition import Condition
from domain.errors import PilothouseError
from domain.health.signals import Recovery, default_signals
from domain.inputs import (
    AcknowledgeRequest,
    HoldRequest,
    Input,
    ModeRequest,
    NodeReport,
    Reading,
    Readings,
    ReleaseRequest,
    ShelveRequest,
    TimePassed,
    UnshelveRequest,
)
from domain.lifecycle import LifecycleState
from domain.outbox import Outputs
from domain.parts.declared_errors import DeclaredError
from domain.snapshot import NO_MARKS, ErrorKey
from domain.state_and_mode import PartName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import Instant, seconds
from tests.support.models import nested_model

STORIES = 10_000 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 60
MODEL = nested_model()
QUIET = Condition("hold.quiet or battery_level < 0.4")
SILENCED_BY_THE_MODEL = replace(
    MODEL,
    errors={
        node: {
            "UNREACHABLE": DeclaredError(suppressed_when=QUIET),
            "DEVIATES": DeclaredError(suppressed_when=QUIET),
        }
        for node in MODEL.nodes
    },
)
LATCHING = SupervisionSettings(
    signals=tuple(
        replace(
            item,
            recovery=Recovery.ACKNOWLEDGE if item.spec.name == "temperature" else item.recovery,
        )
        for item in default_signals()
    )
)

NODES = st.sampled_from(list(MODEL.nodes))
KEYS = st.sampled_from(
    [
        *(ErrorKey(None, name) for name in ("BATTERY_LOW", "TEMPERATURE_HIGH", "STALE_DATA")),
        *(ErrorKey(part, "DEVIATES") for part in MODEL.parts),
        *(ErrorKey(node, "UNREACHABLE") for node in MODEL.nodes),
    ]
)
STATES = st.sampled_from(
    [LifecycleState.INACTIVE, LifecycleState.ACTIVE, LifecycleState.ERROR_PROCESSING]
)


def _reading(name: str, value: float) -> Input:
    return Readings((Reading(name, value),), "test")


INPUTS: st.SearchStrategy[Input] = st.one_of(
    st.builds(lambda v: _reading("battery_level", v), st.sampled_from([0.3, 0.45, 0.9])),
    st.builds(lambda v: _reading("temperature", v), st.sampled_from([20.0, 60.0])),
    st.builds(lambda node, r: NodeReport(node, reachable=r), NODES, st.booleans()),
    st.builds(lambda node, s: NodeReport(node, state=s), NODES, STATES),
    st.builds(lambda part: ModeRequest(part, "__DEFAULT__"), st.sampled_from(list(MODEL.parts))),
    st.builds(lambda key: AcknowledgeRequest(key.error, part=key.part), KEYS),
    st.sampled_from([HoldRequest("quiet", "service"), ReleaseRequest("quiet")]),
    st.just(TimePassed()),
)
SILENCING: st.SearchStrategy[Input] = st.one_of(
    st.builds(
        lambda key, for_s: ShelveRequest(key.error, seconds(for_s), "noise", part=key.part),
        KEYS,
        st.sampled_from([0.1, 1.0, 60.0]),
    ),
    st.builds(lambda key: UnshelveRequest(key.error, part=key.part), KEYS),
)
STEPS = st.lists(
    st.tuples(st.sampled_from([0.0, 0.1, 1.2, 30.0]), INPUTS, st.none() | SILENCING), max_size=40
)
ANNOUNCING = {"error.shelved", "error.unshelved", "error.chattering"}


def told(outputs: Outputs) -> list[tuple[Instant, str, str]]:
    """Return what was told besides the announcing; ids differ, since more is told."""
    return [
        (event.at, event.kind, str({**event.data, "silenced": None}))
        for event in outputs.events
        if event.kind not in ANNOUNCING
    ]


def known(core: Supervision) -> Iterator[object]:
    """Yield all that one can see, without what is silenced."""
    yield core.system_state()
    yield from (replace(view, marks=NO_MARKS) for view in core.errors())
    for view in core.parts().values():
        yield view.actual, view.target, view.converged, view.change, view.deviation_since


def give(core: Supervision, given_: Input, now: Instant) -> Outputs:
    with suppress(PilothouseError):
        return core.handle(given_, now)
    return Outputs()


@settings(max_examples=STORIES, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(STEPS)
def test_what_is_silenced_changes_nothing_but_what_is_announced(
    steps: list[tuple[float, Input, Input | None]],
) -> None:
    loud = Supervision(MODEL, LATCHING, 0)
    silenced = Supervision(SILENCED_BY_THE_MODEL, LATCHING, 0)
    now: Instant = 0
    for node in MODEL.nodes:
        report = NodeReport(PartName(node), state=LifecycleState.UNCONFIGURED, reachable=True)
        for core in (loud, silenced):
            core.handle(report, now)
    for wait_s, given_, silencing in steps:
        now += seconds(wait_s)
        for same in (TimePassed(), given_):
            ours, theirs = give(loud, same, now), give(silenced, same, now)
            assert ours.commands == theirs.commands
            assert told(ours) == told(theirs)
        if silencing is not None:
            quietly = give(silenced, silencing, now)
            assert not quietly.commands
            assert not told(quietly)
        assert list(known(loud)) == list(known(silenced))
