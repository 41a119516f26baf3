"""Robots whose model has rules, and what a story of rules needs of them."""

from dataclasses import replace

from domain.commands import AskFacts, AskTransition
from domain.lifecycle import Transition
from domain.parts.system_model import NodeModel, Rule, SmhModel, SystemModel
from domain.snapshot import EffectiveTarget
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from domain.supervision import SupervisionSettings
from domain.timebase import Instant
from tests.support.good import GOOD
from tests.support.models import (
    ACTUATION,
    ARM,
    BASE,
    active,
    actuation_model,
    inactive,
    nested_model,
)
from tests.support.restarting_robot import RestartingRobot

DEGRADE, PARK = "degrade", "park"
ROBOT = PartName("robot")
GUARD, CAMERA, SAFETY = PartName("guard"), PartName("camera"), PartName("safety")
COMPROMISED = ModeName("COMPROMISED")


def degrading_model(*more: Rule) -> SmhModel:
    """Return the robot of D4.8 with rules: no PERFORMANCE without the arm, or without the base."""
    return with_rules(
        actuation_model(),
        ACTUATION,
        Rule(DEGRADE, active("PERFORMANCE"), (ARM, inactive()), active()),
        Rule(PARK, active("PERFORMANCE"), (BASE, inactive()), inactive()),
        *more,
    )


def with_rules(model: SmhModel, system: PartName, *rules: Rule) -> SmhModel:
    """Return a model in which a system has these rules."""
    ruled = replace(model.systems[system], rules=rules)
    return SmhModel(model.nodes, {**model.systems, system: ruled}, model.mode_settings)


def nested_ruled_model() -> SmhModel:
    """Return a robot in which a system slows down with its arm, and the robot with that system."""
    inner = Rule(DEGRADE, active("PERFORMANCE"), (ARM, inactive()), active("MODERATE"))
    outer = Rule("calm", active("RACE"), (ACTUATION, active("MODERATE")), active())
    return with_rules(with_rules(nested_model(), ACTUATION, inner), ROBOT, outer)


def guarded_model() -> SmhModel:
    """Return the model of system_modes issue #94: two rules that undo each other."""
    nodes = {
        name: NodeModel(name, {DEFAULT_MODE: {"p": 0.5}, COMPROMISED: {"p": 0.1}})
        for name in (CAMERA, GUARD)
    }
    modes = {
        DEFAULT_MODE: {CAMERA: active(), GUARD: active()},
        COMPROMISED: {CAMERA: inactive(), GUARD: active(COMPROMISED)},
    }
    rules = (
        Rule("compromise", active(), (GUARD, active(COMPROMISED)), active(COMPROMISED)),
        Rule("relax", active(COMPROMISED), (GUARD, active()), active()),
    )
    return SmhModel(nodes, {SAFETY: SystemModel(SAFETY, modes, rules)})


class RuledRobot(RestartingRobot):
    """A robot that others than the service command too."""

    def __init__(self, model: SmhModel, settings: SupervisionSettings | None = None) -> None:
        super().__init__(model, settings)
        self.read(**GOOD)

    def come_back(self) -> None:
        """Restart the service, and let it ask all nodes what they are in."""
        self.restart()
        for node in self.model.nodes:
            self.nodes.handle(AskFacts(0, node), self.now)
        self.advance(0)

    def somebody_asks(self, node: str, transition: str) -> None:
        """Let somebody else ask a node for a transition; let that be done."""
        command = AskTransition(0, PartName(node), Transition(transition))
        self.nodes.handle(command, self.now)
        self.advance(0.2)
        assert self.core.part(PartName(node)).actual.state is command.transition.goal

    def somebody_sets(self, node: str, mode: str) -> None:
        """Let the parameters of a node become those of a mode, by nobody's request."""
        values = self.model.nodes[PartName(node)].modes[ModeName(mode)]
        self.nodes.set_parameters(PartName(node), values, self.now)
        self.advance(0)

    def pursued(self, part: str) -> EffectiveTarget:
        """Return the target in force of a part, which must have one."""
        target = self.core.part(PartName(part)).effective_target
        assert target is not None
        return target

    def target(self, part: str) -> str:
        """Return the target in force as a label, with the rule that set it, if any."""
        pursued = self.pursued(part)
        label = StateAndMode(pursued.state, pursued.mode).label
        return f"{label} by {pursued.rule}" if pursued.rule else label

    def asked(self, part: str) -> str | None:
        """Return the requested target of a part as a label."""
        target = self.core.part(PartName(part)).target
        return target.label if target else None

    def why(self, part: str) -> list[tuple[str, str]]:
        """Return code and words of why the requested target of a part is not in force."""
        return [(why.code, why.message) for why in self.pursued(part).blockers]

    def happened_at(self, kind: str, part: str, actual: str) -> Instant:
        """Return when a part last became what a label says."""
        wanted = {"part": part, "actual": actual}
        times = [e.at for e in self.events if e.kind == kind and wanted.items() <= e.data.items()]
        return times[-1]

    def in_performance(self) -> "RuledRobot":
        """Reach PERFORMANCE."""
        self.ask_mode("actuation", "PERFORMANCE")
        self.advance(2)
        assert self.actual("actuation") == "active.PERFORMANCE"
        return self

    def degraded(self) -> "RuledRobot":
        """Reach PERFORMANCE, lose the arm, and let the rule act."""
        self.in_performance().somebody_asks("manipulator", "deactivate")
        self.advance(2)
        assert self.target("actuation") == f"active.{DEFAULT_MODE} by {DEGRADE}"
        return self
