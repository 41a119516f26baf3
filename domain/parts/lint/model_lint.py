"""All warnings about a valid model.

Source: reports of users of micro-ROS system_modes (issues #43, #94).
"""

from domain.conditions.vocabulary import Vocabulary
from domain.findings import Finding
from domain.parts.lint.alike import modes_alike
from domain.parts.lint.budget import Budget
from domain.parts.lint.demands import Demands, conflicting_demands
from domain.parts.lint.guards import GuardLint
from domain.parts.lint.names import reserved_words
from domain.parts.lint.parameters import never_inferred, types_that_differ
from domain.parts.lint.plans import PlanLint
from domain.parts.lint.possible import PossibleValues
from domain.parts.lint.rules import rules_in_a_circle, rules_that_undo_a_request
from domain.parts.lint.satisfiable import Satisfiability
from domain.parts.lint.shared_parts import conflicting_systems
from domain.parts.system_model import SmhModel


def lint(model: SmhModel, vocabulary: Vocabulary) -> list[Finding]:
    """Return warnings; the effort grows with the size of the model, and is bounded.

    Args:
        model: The model.
        vocabulary: What its conditions can name.
    """
    budget = Budget()
    demands, possible = Demands(model, budget), PossibleValues(model, vocabulary)
    satisfiability = Satisfiability(budget)
    findings = list(modes_alike(model))
    for node in model.nodes.values():
        findings.extend(types_that_differ(node))
        findings.extend(never_inferred(node))
    for system in model.systems.values():
        findings.extend(rules_that_undo_a_request(system, demands))
        findings.extend(rules_in_a_circle(system))
    findings.extend(conflicting_systems(model))
    conflicts = conflicting_demands(model, demands, budget)
    findings.extend(PlanLint(model, possible, satisfiability, budget).findings(conflicts))
    guards = GuardLint(model, possible, demands, satisfiability)
    for part in model.mode_settings:
        for mode in model.modes_of(part):
            findings.extend(guards.findings(part, mode))
    findings.extend(reserved_words(model))
    return findings
