"""What lint says that no plan reaches is never reached, whatever is requested in which order.

`make soak` plays 5,000 stories, `make test` 150.
"""

import os
from collections.abc import Mapping, Sequence
from contextlib import suppress

import hypothesis.strategies as st
from hypothesis import event, given, settings

from domain.conditions.condition import Condition
from domain.errors import PilothouseError
from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.snapshot import ChangeStatus
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.lint_models import lint_of
from tests.support.models import active, inactive

STORIES = 5_000 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 150

MODES = (DEFAULT_MODE, ModeName("SLOW"), ModeName("FAST"))
NODES = tuple(PartName(name) for name in ("a", "b", "c"))
LEFT, RIGHT, TOP = PartName("left"), PartName("right"), PartName("top")
PARTS = (*NODES, LEFT, RIGHT, TOP)
PAIRS = (inactive(), *(active(mode) for mode in MODES))

LEAVES = st.sampled_from(
    [f"{part}.mode {sign} {mode}" for part in PARTS for sign in ("==", "!=") for mode in MODES]
    + [f"{part}.state == {state}" for part in PARTS for state in ("active", "inactive")]
    + ["battery_level > 0.6", "battery_level < 0.4", "temperature < 30"]
)
CONDITIONS = LEAVES | st.builds(
    "{} {} {}".format, LEAVES, st.sampled_from(["and", "or"]), LEAVES
).map(Condition.parse).map(lambda condition: condition.text)
GUARDS = st.lists(CONDITIONS.map(Condition.parse), max_size=2).map(tuple)
SETTINGS = st.dictionaries(
    st.sampled_from(MODES), st.builds(ModeSettings, requires=GUARDS, invariants=GUARDS), max_size=2
)


def _system(name: PartName, parts: Sequence[PartName]) -> st.SearchStrategy[SystemModel]:
    wanted: st.SearchStrategy[Mapping[PartName, StateAndMode]] = st.fixed_dictionaries(
        dict.fromkeys(parts, st.sampled_from(PAIRS))
    )
    return st.builds(
        SystemModel, st.just(name), st.fixed_dictionaries(dict.fromkeys(MODES, wanted))
    )


@st.composite
def models(draw: st.DrawFn) -> SmhModel:
    """Return two systems that share a node, in a third one, with guards on any of the modes."""
    nodes = {
        name: NodeModel(name, {mode: {"p": number} for number, mode in enumerate(MODES)})
        for name in NODES
    }
    systems = {
        TOP: draw(_system(TOP, (LEFT, RIGHT))),
        LEFT: draw(_system(LEFT, NODES[:2])),
        RIGHT: draw(_system(RIGHT, NODES[1:])),
    }
    guarded = draw(st.lists(st.sampled_from(PARTS), unique=True, max_size=3))
    return SmhModel(nodes, systems, {part: draw(SETTINGS) for part in guarded})


@settings(max_examples=STORIES)
@given(
    models(),
    st.lists(
        st.tuples(st.sampled_from(PARTS), st.sampled_from(MODES))
        | st.sampled_from([0.2, 0.5, 0.9]),
        min_size=5,
        max_size=25,
    ),
)
def test_what_no_plan_reaches_is_not_reached(
    model: SmhModel, acts: list[tuple[PartName, ModeName] | float]
) -> None:
    unreachable = {
        (finding.path[0], finding.path[2])
        for finding in lint_of(model)
        if finding.code == "UNREACHABLE_MODE"
    }
    robot = CoreRobot(model)
    robot.read(**GOOD)

    for act in acts:
        if isinstance(act, float):
            robot.read(battery_level=act)
            continue
        with suppress(PilothouseError):
            change = robot.ask_mode(*act)
            robot.advance(6)
            if robot.change(change).status is ChangeStatus.SUCCEEDED:
                event("a mode was reached")
                assert act not in unreachable
    if unreachable:
        event("no plan reaches a mode")
