"""Random reactions and causes: a passive reaction tells when its active twin acts, and only then.

`make soak` compares 10,000 pairs of robots, `make test` 200.
"""

import os
from typing import NamedTuple

import hypothesis.strategies as st
import pytest
from hypothesis import HealthCheck, given, settings

from domain.timebase import Instant
from tests.support.reacting_robot import FLAGS, ReactingRobot

SOAK = os.environ.get("PILOTHOUSE_SOAK") == "1"
PAIRS = 10_000 if SOAK else 200

ACTIONS = {
    "tell": "action: tell",
    "slow": "action: mode, target: active.SLOW",
    "crawl": "action: mode, target: active.CRAWL",
    "rest": "action: state, target: inactive",
    "off": "action: state, target: unconfigured",
    "hold": "action: hold",
    "stop": "action: stop",
}
BUDGETED = ("slow", "crawl", "rest", "off")
CONDITIONS = ("a", "not b", "a and b", "a or c", "b and not c")

budgets = st.builds(
    ", at_most: {}, in_s: {}, on_exhausted: {}".format,
    st.integers(1, 3),
    st.sampled_from([1, 4, 60]),
    st.sampled_from(["tell", "hold"]),
)


@st.composite
def bodies(draw: st.DrawFn) -> str:
    """Draw what a reaction says besides its name and its arm."""
    action = draw(st.sampled_from(list(ACTIONS)))
    body = f'when: "{draw(st.sampled_from(CONDITIONS))}", {ACTIONS[action]}'
    if action in BUDGETED:
        body += draw(st.just("") | budgets)
    if draw(st.booleans()):
        body += ", until: acknowledged"
    return body + draw(st.sampled_from(["", ", for_s: 0.5", ", for_s: 1"]))


class Step(NamedTuple):
    """What happens, and how long nothing happens then."""

    flags: dict[str, bool]
    seen: int | None
    """The reaction that somebody acknowledges."""
    wait_s: float


steps = st.builds(
    Step,
    st.dictionaries(st.sampled_from(FLAGS), st.booleans(), max_size=2),
    st.none() | st.integers(0, 3),
    st.sampled_from([0.1, 0.5, 1.0, 1.5]),
)


def played(reactions: list[str], twin: int, arm: str, story: list[Step]) -> ReactingRobot:
    """Return a robot after a story; one of its reactions is armed in one way.

    Args:
        reactions: What each says.
        twin: Which one is armed.
        arm: How.
        story: What happens.
    """
    lines = [
        f"R{number}: {{{body}{f', arm: {arm}' if number == twin else ''}}}"
        for number, body in enumerate(reactions)
    ]
    # What is false may call for something, too, and would refuse the first request.
    robot = ReactingRobot(*lines, calm=False).see(0.0, **dict.fromkeys(FLAGS, False))
    for step in story:
        robot.see(0.0, **step.flags)
        if step.seen is not None and step.seen < len(reactions):
            robot.acknowledge_reaction(f"R{step.seen}")
        robot.advance(step.wait_s)
    return robot


def told(robot: ReactingRobot, twin: int, kind: str) -> list[tuple[Instant, object]]:
    return [
        (event.at, event.data["reason"])
        for event in robot.events
        if event.kind == f"reaction.{kind}" and event.data["reaction"] == f"R{twin}"
    ]


@pytest.mark.timeout(0 if SOAK else 300)
@given(st.lists(bodies(), min_size=1, max_size=4), st.data(), st.lists(steps, max_size=8))
@settings(
    max_examples=PAIRS,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
def test_a_passive_reaction_would_act_exactly_when_its_active_twin_acts(
    reactions: list[str], data: st.DataObject, story: list[Step]
) -> None:
    twin = data.draw(st.integers(0, len(reactions) - 1), label="twin")
    active = played(reactions, twin, "active", story)
    passive = played(reactions, twin, "passive", story)

    assert told(passive, twin, "would_act") == told(active, twin, "acting")
    others = {"acting", "ended", "overruled", "exhausted"}
    assert others.isdisjoint(passive.told(f"R{twin}"))
    shown, would = active.reaction(f"R{twin}"), passive.reaction(f"R{twin}")
    assert (shown.left, shown.since) == (would.left, would.since)
    assert f"reaction:R{twin}" not in passive.holds
