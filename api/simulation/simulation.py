"""Runs a scenario: steps at their times, samples on a grid, deadlines in between."""

import asyncio
import heapq
from collections.abc import Callable, Iterator, Sequence
from itertools import chain
from typing import Any

from pydantic_core import from_json

from api.http.schemas.base import BlockerJson
from api.http.schemas.simulation import (
    ActingStep,
    AnyStep,
    ConditionStep,
    DifferenceJson,
    ExpectationJson,
    ExpectStep,
    ReadingStep,
    RefusalJson,
    SimulationBody,
)
from api.simulation.expectations import differences
from api.simulation.samples import Sampler
from api.simulation.steps import Actors
from domain.conditions.condition import Condition
from domain.conditions.evaluation import evaluate
from domain.conditions.explanation import explain
from domain.events.event import RecordedEvent
from domain.timebase import NANOSECONDS_PER_SECOND, Duration, seconds, to_seconds
from service.simulation.virtual_time import VirtualService

MAX_REFUSALS = 1_000
"""Further unexpected rejections are not listed."""

_STRIDE = seconds(10)
"""Longest simulated time between two collections of events."""


class Simulation:
    """One scenario on one robot; `run` it once, then read the results.

    At one instant, deadlines come first, then the steps in their order, each with its immediate
    consequences, then the sample. Only the sample at the start comes before the first step.
    """

    def __init__(self, body: SimulationBody, robot: VirtualService) -> None:
        self._body = body
        self._robot = robot
        self._begin = robot.clock.now()
        self._sampler = Sampler(robot.supervisor)
        self.samples: list[str] = []
        """As JSON."""
        self.refusals: list[RefusalJson] = []
        self.expectations: list[ExpectationJson] = []
        """Of `expect` steps, and of steps with `refused: true`."""
        self._unexpected = 0
        self._progress: Callable[[float], None] = lambda _: None

    @property
    def events(self) -> Sequence[RecordedEvent]:
        """Return all events so far."""
        return self._sampler.events

    def seconds_to(self, event: RecordedEvent) -> float:
        """Return the time of an event since the start, s."""
        return to_seconds(event.at - self._begin)

    def failed_expectations(self) -> list[ExpectationJson]:
        """Return the steps whose expectations were not met."""
        return [found for found in self.expectations if found.differences]

    def unexpected_refusals(self) -> list[RefusalJson]:
        """Return the steps that were rejected unexpectedly."""
        steps = self._body.steps
        return [found for found in self.refusals if not _may_be_refused(steps[found.step])]

    def run(self, progress: Callable[[float], None] = lambda _: None) -> None:
        """Run the scenario.

        Args:
            progress: Called repeatedly with the simulated time so far, s.

        Raises:
            TooComplexError: The results are too large.
        """
        self._progress = progress
        with asyncio.Runner() as runner:
            actors = Actors(self._robot, runner)
            self._advance(0)
            self._take_sample(0)
            samples = iter(self._sample_times())
            next_sample = next(samples, None)
            for at, index in self._timeline():
                while next_sample is not None and next_sample < at:
                    self._advance(next_sample)
                    self._take_sample(next_sample)
                    next_sample = next(samples, None)
                self._advance(at)
                if index is not None:
                    self._let_happen(actors, index, at)
            if next_sample is not None:
                self._take_sample(next_sample)

    def as_json(self) -> str:
        """Return the results as `SimulationJson`."""
        refusals = ",".join(item.model_dump_json(exclude_unset=True) for item in self.refusals)
        expectations = ",".join(item.model_dump_json() for item in self.expectations)
        return (
            f'{{"samples":[{",".join(self.samples)}],'
            f'"events":[{",".join(self._sampler.event_texts())}],'
            f'"refusals":[{refusals}],"expectations":[{expectations}]}}'
        )

    def _timeline(self) -> Iterator[tuple[Duration, int | None]]:
        """Yield each time with its step, in order, and finally the end."""
        end = seconds(self._body.until_s)
        coming = [(seconds(step.t_s), index, 0) for index, step in enumerate(self._body.steps)]
        heapq.heapify(coming)
        while coming and coming[0][0] <= end:
            at, index, count = heapq.heappop(coming)
            yield at, index
            step = self._body.steps[index]
            if isinstance(step, ReadingStep) and step.repeat_hz is not None:
                count += 1
                if count < step.count(self._body.until_s):
                    later = round(count * NANOSECONDS_PER_SECOND / step.repeat_hz)
                    heapq.heappush(coming, (seconds(step.t_s) + later, index, count))
        yield end, None

    def _sample_times(self) -> Iterator[Duration]:
        """Return the times of the samples after the one at the start."""
        period = seconds(self._body.sample_period_s)
        end = seconds(self._body.until_s)
        return iter(range(period, end + 1, period)) if period else iter(())

    def _advance(self, at: Duration) -> None:
        end = self._begin + at
        while True:
            now = min(self._robot.clock.now() + _STRIDE, end)
            self._robot.advance_to(now)
            self._sampler.collect_events()
            self._progress(to_seconds(now - self._begin))
            if now == end:
                return

    def _let_happen(self, actors: Actors, index: int, at: Duration) -> None:
        step = self._body.steps[index]
        if isinstance(step, ConditionStep):
            self._judge(step, index, at)
            return
        if isinstance(step, ExpectStep):
            found = list(self._compare(step, at))
            self.expectations.append(
                ExpectationJson(step=index, t_s=to_seconds(at), differences=found)
            )
            return
        problem = actors.act(step)
        if problem is not None:
            self._unexpected += not step.refused
            if step.refused or self._unexpected <= MAX_REFUSALS:
                self.refusals.append(RefusalJson(step=index, t_s=to_seconds(at), problem=problem))
        if step.refused:
            found = [] if problem else [DifferenceJson(path="refused", expected=True, seen=False)]
            self.expectations.append(
                ExpectationJson(step=index, t_s=to_seconds(at), differences=found)
            )
        self._advance(at)

    def _take_sample(self, at: Duration) -> None:
        self.samples.append(self._sampler.kept_sample(to_seconds(at), len(self.samples)))

    def _judge(self, step: ConditionStep, index: int, at: Duration) -> None:
        """Evaluate a condition; one that is not true is explained."""
        condition, facts = Condition.parse(step.expect), self._robot.supervisor.core.facts
        truth = evaluate(condition, facts).name.lower()
        self.expectations.append(
            ExpectationJson(
                step=index,
                t_s=to_seconds(at),
                differences=[]
                if truth == "true"
                else [DifferenceJson(path="", expected=step.expect, seen=truth)],
                blockers=[
                    BlockerJson.of(blocker, self._robot.clock)
                    for blocker in explain(condition, facts)
                ],
            )
        )

    def _compare(self, step: ExpectStep, at: Duration) -> Iterator[DifferenceJson]:
        """Compare with a current sample, with the last task, and with the counts of events."""
        expected = dict(step.expect)
        events = expected.pop("events", {})
        seen: dict[str, Any] = from_json(self._sampler.sample(to_seconds(at), 0))
        last = next(self._robot.supervisor.core.driving.tasks(), None)
        seen["last_task"] = None if last is None else from_json(self._sampler.task_text(last))
        counts = self._sampler.counts()
        happened = {kind: counts[kind] for kind in chain(events, counts)}
        return chain(differences(expected, seen), differences(events, happened, "events"))


def _may_be_refused(step: AnyStep) -> bool:
    return isinstance(step, ActingStep) and step.refused
