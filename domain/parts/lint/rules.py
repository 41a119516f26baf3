"""Rules that undo each other, or a request."""

from collections import defaultdict
from collections.abc import Iterator

from domain.circles import circles, in_words
from domain.findings import Finding
from domain.parts.lint.demands import Demands
from domain.parts.lint.warning import meaning, warning
from domain.parts.system_model import Rule, SystemModel
from domain.state_and_mode import StateAndMode


def rules_that_undo_a_request(system: SystemModel, demands: Demands) -> Iterator[Finding]:
    """Yield a warning for each rule that gives up a target for what the target itself demands."""
    for rule in system.rules:
        part, condition = rule.if_part
        wanted = demands.of_pair(system.name, rule.if_target, part)
        if any(want.agrees_with(condition) for want in wanted) and part != system.name:
            message = (
                f"rule {rule.name} of {system.name} gives up {rule.if_target.label} when {part} is "
                f"{condition.label}, which {rule.if_target.label} itself requires"
            )
            yield warning("RULE_UNDOES_REQUEST", message, system.name, "rules", rule.name)


def rules_in_a_circle(system: SystemModel) -> Iterator[Finding]:
    """Yield a warning for each circle of targets, at the rule that closes it."""
    rules: dict[StateAndMode, list[Rule]] = defaultdict(list)
    for rule in system.rules:
        rules[meaning(rule.if_target)].append(rule)
    goals = {target: [meaning(r.new_target) for r in own] for target, own in rules.items()}
    for circle in circles(goals):
        *_, last, goal = circle
        closing = next(r for r in rules[last] if meaning(r.new_target) == goal)
        words = in_words([target.label for target in circle], " > ")
        message = f"rules of {system.name} form a cycle: {words}"
        yield warning("RULE_CIRCLE", message, system.name, "rules", closing.name)
