"""Random runs: errors of parts are on exactly when an evaluator of its own says so.

`make soak` tells 3,000 stories, `make test` 40.
"""

import os
from collections import Counter
from collections.abc import Mapping
from contextlib import suppress

import hypothesis.strategies as st
from hypothesis import HealthCheck, given, settings

from domain.errors import PilothouseError
from domain.inputs import Input, NodeReport
from domain.lifecycle import LifecycleState
from domain.outbox import Outputs
from domain.parameters import same_value
from domain.simulation.node_settings import Fault
from domain.snapshot import PartView
from domain.state_and_mode import PartName
from domain.timebase import Instant, seconds
from tests.support.core_robot import CoreRobot
from tests.support.models import nested_model

GRACE = seconds(1)
MODEL = nested_model()
NODES = st.sampled_from(list(MODEL.nodes))
PARTS = st.sampled_from(list(MODEL.parts))
STORIES = 3_000 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 40


class Observed(CoreRobot):
    """A robot that is compared with the evaluator after every input."""

    def __init__(self) -> None:
        self.deviates_since: dict[PartName, Instant] = {}
        self.failed: set[PartName] = set()
        self.maybe_failed: set[PartName] = set()
        """Parts of systems that succeeded: whether the change drove them is not asked here."""
        super().__init__(nested_model())

    def give(self, given: Input) -> Outputs:
        outputs = super().give(given)
        for event in outputs.events:
            self._note_end(event.kind, str(event.data.get("part")))
        self._note_deviations()
        self.compare()
        return outputs

    def _note_end(self, kind: str, part: str) -> None:
        name = PartName(part)
        if kind in ("change.failed", "change.timed_out"):
            self.failed.add(name)
            self.maybe_failed.discard(name)
        elif kind == "change.succeeded":
            self.failed.discard(name)
            self.maybe_failed.discard(name)
            below = {p for p in self.failed if name in MODEL.ancestors[p]}
            self.failed -= below
            self.maybe_failed |= below

    def _note_deviations(self) -> None:
        views = self.core.parts()
        for part, view in views.items():
            if deviates_now(view, views):
                self.deviates_since.setdefault(part, self.now)
            else:
                self.deviates_since.pop(part, None)

    # --- what has to be ------------------------------------------------------------------------

    def on(self, part: PartName) -> set[str]:
        """Return the errors that have to be on, as far as they can be told from outside."""
        view, found = self.core.part(part), set[str]()
        if part in MODEL.nodes:
            if not view.reachable:
                found.add("UNREACHABLE")
            if view.actual.state is LifecycleState.ERROR_PROCESSING:
                found.add("ERROR_PROCESSING")
            if self._has_drifted(view):
                found.add("PARAMETERS_DRIFTED")
        since = self.deviates_since.get(part)
        if since is not None and self.now - since >= GRACE:
            found.add("DEVIATES")
        if part in self.failed:
            found.add("CHANGE_FAILED")
        return found

    def _has_drifted(self, view: PartView) -> bool:
        if view.change is not None or view.actual.state is not LifecycleState.ACTIVE:
            return False
        return any(
            item.wanted is not None
            and item.value is not None
            and not same_value(item.value, item.wanted)
            for item in self.core.parameters(view.name)
        )

    def compare(self) -> None:
        on = 0
        for part in MODEL.parts:
            views = list(self.core.errors_of(part))
            shown = {view.key.error for view in views if view.state.is_on}
            on += len(shown)
            if part in self.maybe_failed:
                shown.discard("CHANGE_FAILED")
            assert shown == self.on(part), (part, self.now)
            assert all((view.since is None) is (view.state == "normal") for view in views)
        every = list(self.core.errors())
        assert sum(self.core.parts_with_errors.values()) == on
        assert sum(view.first_out for view in every) == any(view.state.is_on for view in every)
        kept_open = {view.key.name: view for view in every if view.state != "normal"}
        assert kept_open == self.core.open_errors()


def deviates_now(view: PartView, views: Mapping[PartName, PartView]) -> bool:
    """Tell whether a part is not where its target says, and no change works on that."""
    if view.effective_target is None or view.converged or view.change is not None:
        return False
    assert view.deviation_reason is not None
    why = PartName(view.deviation_reason.split(" is ")[0])
    return views[why].change is None


STEPS = st.one_of(
    st.tuples(st.just("wait"), st.sampled_from([0.0, 0.05, 0.3, 0.999, 1.0, 2.5, 11.0])),
    st.tuples(st.just("mode"), PARTS, st.integers(0, 2)),
    st.tuples(st.just("transition"), PARTS, st.sampled_from(["configure", "activate", "cleanup"])),
    st.tuples(st.just("fault"), NODES, st.sampled_from([None, *Fault])),
    st.tuples(st.just("report"), NODES, st.sampled_from(LifecycleState)),
    st.tuples(st.just("drift"), NODES, st.integers(0, 2)),
    st.tuples(st.just("stop"), st.booleans()),
)


def carry_out(robot: Observed, step: tuple[object, ...]) -> None:
    match step:
        case "wait", float(duration_s):
            robot.advance(duration_s)
        case "mode", str(part), int(number):
            modes = MODEL.modes_of(PartName(part))
            robot.ask_mode(part, modes[number % len(modes)])
        case "transition", str(part), str(transition):
            robot.ask_transition(part, transition)
        case "fault", str(node), fault:
            robot.fault(node, None if fault is None else Fault(str(fault)))
        case "report", str(node), state:
            robot.give(NodeReport(PartName(node), LifecycleState(str(state))))
        case "drift", str(node), int(number):
            of_modes = list(MODEL.nodes[PartName(node)].modes.values())
            values = of_modes[number % len(of_modes)]
            robot.nodes.set_parameters(PartName(node), values, robot.now)
            robot.advance(0)
        case "stop", bool(engaged):
            robot.stop() if engaged else robot.release_stop()


@settings(
    max_examples=STORIES,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
@given(st.lists(STEPS, max_size=25))
def test_errors_of_parts_are_on_exactly_when_facts_targets_and_changes_say_so(
    steps: list[tuple[object, ...]],
) -> None:
    robot = Observed()
    for step in steps:
        with suppress(PilothouseError):
            carry_out(robot, step)
    robot.advance(15)
    told: Counter[tuple[str, str]] = Counter()
    raised: Counter[tuple[str, str]] = Counter()
    for event in robot.events:
        if event.kind in ("error.raised", "error.cleared") and event.data["part"] is not None:
            key = (str(event.data["part"]), str(event.data["error"]))
            told[key] += 1 if event.kind == "error.raised" else -1
            raised[key] += event.kind == "error.raised"
            assert told[key] in (0, 1), "raised and cleared in turn"
    for view in robot.core.errors():
        if view.key.part is not None:
            key = (view.key.part, view.key.error)
            assert (told[key] == 1) is view.state.is_on
            assert view.count == raised[key]
