"""Decides whether a report ends the step that a node is executing, and how."""

from dataclasses import dataclass

from domain.changes.plan import SetParameters
from domain.changes.record import Step
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState, Transition, rule_for
from domain.parameters import same_value
from domain.parts.node_facts import NodeFacts
from domain.snapshot import StepStatus


@dataclass(frozen=True, slots=True)
class Verdict:
    """How a step ended."""

    status: StepStatus
    error: str | None = None


_DONE = Verdict(StepStatus.SUCCEEDED)


def judge_report(step: Step, report: NodeReport, facts: NodeFacts) -> Verdict | None:
    """Return how `report` ends `step`; None: the step continues.

    Args:
        step: The step in flight; it notes that its node was seen in the transitional state.
        report: The newest report of its node.
        facts: Facts about the node, including `report`.
    """
    if isinstance(step.action, SetParameters):
        return _judge_parameters(step, step.action, report, facts)
    return _judge_transition(step, step.action, report)


def _judge_parameters(
    step: Step, action: SetParameters, report: NodeReport, facts: NodeFacts
) -> Verdict | None:
    """Done when all values are set, and a node that reports its mode reports the new one."""
    if report.parameters is None and report.mode is None:
        return None
    known = facts.parameters
    wrong = [n for n, v in action.values.items() if n not in known or not same_value(known[n], v)]
    if action.mode is not None and facts.mode not in (None, action.mode):
        wrong.append(f"mode {facts.mode}")
    if not wrong:
        return _DONE
    if step.facts_asked:
        return Verdict(StepStatus.TIMED_OUT, f"not applied: {', '.join(wrong)}")
    return None


def _judge_transition(step: Step, transition: Transition, report: NodeReport) -> Verdict | None:
    """Follow the lifecycle table; a return to the start state after the transition is a failure."""
    rule = rule_for(step.start_state, transition)
    if rule is None or report.state is None:
        return None
    state = report.state
    if state is rule.success:
        return _DONE
    if state is LifecycleState.ERROR_PROCESSING:
        return Verdict(StepStatus.FAILED, "the node ran into an error (errorprocessing)")
    if state is rule.via:
        step.seen_on_the_way = True
    elif state is not rule.start:
        return Verdict(StepStatus.FAILED, f"the node is {state} instead of {rule.success}")
    elif step.seen_on_the_way:
        return Verdict(StepStatus.FAILED, f"the node went back to {state}")
    if step.facts_asked:
        return Verdict(StepStatus.TIMED_OUT, f"the node is still {state}")
    return None
