"""Parts as text: the same as `PartJson` gives, whatever they are called and wherever they are."""

from dataclasses import replace
from functools import partial

from hypothesis import given
from hypothesis import strategies as st

from api.http.part_text import part_text
from api.http.schemas.base import timestamp
from api.http.schemas.parts import PartJson
from domain.computers import ComputerName
from domain.findings import Blocker
from domain.identifiers import ChangeId
from domain.lifecycle import LifecycleState
from domain.snapshot import Actual, Because, EffectiveTarget, PartView
from domain.state_and_mode import ModeName, PartName, StateAndMode
from tests.support.manual_clock import ManualClock

CLOCK = ManualClock()

words = st.text(st.characters(exclude_categories=["Cs"]), max_size=12)
names = words.map(PartName)
states = st.sampled_from(LifecycleState)
modes = st.none() | words.map(ModeName)
values = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | words
leaves = st.builds(
    Blocker,
    words,
    words,
    st.lists(words, max_size=2).map(tuple),
    values,
    values,
    since=st.none() | st.integers(0, 10**15),
    root_cause=st.booleans(),
    refuses=st.booleans(),
    condition=st.none() | words,
)
blockers = st.builds(replace, leaves, causes=st.lists(leaves, max_size=2).map(tuple))
views = st.builds(
    PartView,
    name=names,
    kind=st.sampled_from(["system", "node"]),
    parts=st.lists(names, max_size=3).map(tuple),
    target=st.none() | st.builds(StateAndMode, states, modes),
    effective_target=st.none()
    | st.builds(
        EffectiveTarget,
        states,
        modes,
        st.sampled_from(Because),
        st.none() | words,
        st.none() | st.integers(1),
        st.lists(blockers, max_size=2).map(tuple),
    ),
    actual=st.builds(
        Actual,
        states,
        modes,
        inferred=st.booleans(),
        mode_inferred=st.booleans(),
        undecidable=st.booleans(),
        reason=st.none() | words,
    ),
    converged=st.booleans(),
    deviation_since=st.none() | st.integers(0, 10**15),
    deviation_reason=st.none() | words,
    reachable=st.booleans(),
    change=st.none() | words.map(ChangeId),
    device=st.none() | words.map(ComputerName),
    last_known=st.none() | st.builds(StateAndMode, states, modes),
)


@given(views)
def test_a_part_has_the_same_text_as_its_message(view: PartView) -> None:
    shown = part_text(view, partial(timestamp, CLOCK))
    assert shown == PartJson.of(view, CLOCK).model_dump_json()
