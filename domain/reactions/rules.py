"""Rules of the model: what replaces the target of a system while a part is not where it should be.

A rule acts once a deviation has lasted for a time in which no change of its system ran. The system
returns to what was displaced once the cause has been gone for as long: never under ESTOP or because
of its end, never by itself after a restart, and not too often.

Source: micro-ROS system_modes, README ("Error Handling and Rules"), and its issue #94, where rules
undo what was requested.
"""

from collections.abc import Iterable, Mapping

from domain.changes.changing import Changing
from domain.concern import Concern, Takers
from domain.events.targets import RuleNotApplied
from domain.health.health import Health
from domain.inputs import BackendStatus, Restored
from domain.outbox import Outbox
from domain.parts.convergence import bottom_up
from domain.parts.parts import Parts
from domain.reactions.bounds import Bounds
from domain.reactions.displacing import Displacing, Ground
from domain.reactions.returns import RESTARTED, STOPPED, WITHIN, Returns
from domain.reactions.rule_watch import RuleWatch
from domain.reactions.settings import MAX_FIRINGS, MAX_RETURNS, RuleSettings
from domain.reactions.waits import Wait, Waits
from domain.snapshot import Because
from domain.state_and_mode import PartName
from domain.timebase import Instant


class Rules(Concern):
    """Watches the rules of all systems, and decides when they act and when a system returns."""

    def __init__(
        self,
        parts: Parts,
        changing: Changing,
        health: Health,
        settings: RuleSettings,
        displacing: Displacing,
        outbox: Outbox,
    ) -> None:
        """Begin without a rule that acts.

        Args:
            parts: Facts, inferred states and targets of all parts.
            changing: Begins the changes that lead to new targets.
            health: Tells whether ESTOP is active.
            settings: How long conditions must last.
            displacing: Puts targets in force.
            outbox: Receives events.
        """
        self._parts = parts
        self._changing = changing
        self._health = health
        self._outbox = outbox
        self._grace = settings.grace
        self._displacing = displacing
        self._rules = _rules_of(parts)
        self._about = _by_part(self._rules)
        self._matching: Waits[RuleWatch] = Waits()
        """Rules that match, and do not act yet."""
        names = [_bounded(rule) for rule in self._rules]
        self._firings = Bounds("rule", names, MAX_FIRINGS, outbox)
        systems = {rule.system for rule in self._rules}
        bounds = Bounds("rule_return", systems, MAX_RETURNS, outbox)
        self._returns = Returns(parts, displacing, outbox, self._is_free, bounds)

    # --- what happens ----------------------------------------------------------------------------

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {Restored: self.restore, BackendStatus: self._follow_backend}

    def restore(self, restored: Restored, now: Instant) -> None:
        """Displace what an earlier run had displaced."""
        self._displacing.restore(restored, Because.RULE, self._rules, now)
        self._firings.restore(restored.kept, now)
        self._returns.restore(restored.kept, now)

    def _follow_backend(self, status: BackendStatus, now: Instant) -> None:
        self._review(self._rules, now)

    def wake_at(self) -> Instant | None:
        """Return when the next condition has lasted long enough, or a firing counts no more."""
        times = (self._matching.wake_at(), self._firings.wake_at(), self._returns.wake_at())
        return min((at for at in times if at is not None), default=None)

    def pass_time(self, now: Instant) -> None:
        """Note which conditions have lasted long enough."""
        self._matching.pass_time(now)
        self._firings.pass_time(now)
        self._returns.pass_time(now)

    def settle(self, now: Instant) -> bool:
        """Let one rule act, or one system return; return whether one did.

        While other computers may yet be heard, none does.
        """
        if not self._rules:
            return False
        touched = self._about.keys() & self._outbox.parts
        rules = {rule for part in touched for rule in self._about[part]}
        is_explained = self._review(sorted(rules, key=_number), now)
        if self._health.is_stopped:
            self._matching.stop()
            self._returns.stop()
        if self._parts.awaits_devices:
            return is_explained
        return self._act(now) or is_explained

    # --- what holds ------------------------------------------------------------------------------

    def _review(self, rules: Iterable[RuleWatch], now: Instant) -> bool:
        """Note which conditions begin or cease to hold; return whether a reason is shown anew."""
        record, grace, is_explained = self._outbox.record_input, self._grace, False
        for rule in rules:
            if not self._displacing.acts(rule):
                holds = rule.may_act and self._is_free(rule) and rule.matches()
                holds = holds and rule.system not in self._parts.beyond(Because.RULE)
                self._matching.note(rule, now, grace, holds=holds, record=record)
            elif self._displacing.is_ended(rule):
                self._displacing.end_by_request(rule)
                self._returns.forget(rule)
            else:
                is_gone = self._is_free(rule) and rule.is_cause_gone()
                self._returns.note(rule, now, grace, is_gone=is_gone)
                self._displacing.keep(rule)
                if not is_gone and not self._returns.stays(rule):
                    is_explained |= self._displacing.explain_cause(rule)
        return is_explained

    def _is_free(self, rule: RuleWatch) -> bool:
        """Tell whether no change of the system or the part is running, and one could begin."""
        parts = self._parts
        is_changing = parts.change_of(rule.system) or parts.change_of(rule.part)
        return not is_changing and self._changing.is_available

    # --- what follows ----------------------------------------------------------------------------

    def _act(self, now: Instant) -> bool:
        """Let the first system return that may, or else the first rule act."""
        if self._returns.act(now):
            return True
        due = dict(self._matching.over())
        if due:
            rule = min(due, key=_number)
            self._fire(rule, due[rule], now)
        return bool(due)

    def _fire(self, rule: RuleWatch, wait: Wait, now: Instant) -> None:
        """Let a rule act, or say why it does not."""
        way = self._displacing.way_ahead(rule)
        why = self._why_not(rule, wait)
        if why and self._displacing.would_activate(way):
            self._refuse(rule, why, wait, now)
            wait.is_idle = True
            return
        free_at = self._firings.free_at(_bounded(rule), now)
        if free_at > now:
            often = f"it was applied {MAX_FIRINGS} times {WITHIN}"
            self._postpone(rule, often, wait, free_at, now)
        elif guard := self._displacing.guard_ahead(rule, way):
            self._postpone(rule, guard.message, wait, now + self._grace, now)
        else:
            self._matching.end(rule)
            self._firings.note(_bounded(rule), now)
            ground = Ground(rule.reason, (rule.cause(wait.since),), wait.since, wait.cause)
            self._displacing.displace(rule, way, ground, now)
            self._displacing.set_out(rule, way, now)

    def _postpone(
        self, rule: RuleWatch, why: str, wait: Wait, until: Instant, now: Instant
    ) -> None:
        self._refuse(rule, why, wait, now)
        self._matching.postpone(rule, until)

    def _refuse(self, rule: RuleWatch, why: str, wait: Wait, now: Instant) -> None:
        """Tell once that a rule is not applied, and why."""
        if wait.is_told:
            return
        wait.is_told = True
        told = RuleNotApplied(rule.system, rule.name, rule.new_target, why)
        self._outbox.begin(now, told, rule.actor, wait.cause)
        self._outbox.record_input()

    def _why_not(self, rule: RuleWatch, wait: Wait) -> str | None:
        """Return why nothing may be activated; None: it may."""
        if wait.was_stopped:
            return STOPPED
        return RESTARTED if self._parts.waits_for_operator(rule.system) else None


def _rules_of(parts: Parts) -> list[RuleWatch]:
    """Return the rules of all systems: bottom-up, those of one system in the order of the file."""
    model = parts.model
    own = ((system, rule) for system in bottom_up(model) for rule in model.systems[system].rules)
    return [
        RuleWatch(system, rule, number, parts.inference)
        for number, (system, rule) in enumerate(own)
    ]


def _bounded(rule: RuleWatch) -> str:
    """Return the name of a rule among those of all systems."""
    return f"{rule.system}.{rule.name}"


def _number(rule: RuleWatch) -> int:
    return rule.number


def _by_part(rules: Iterable[RuleWatch]) -> Mapping[PartName, list[RuleWatch]]:
    """Return the rules that something about a part may concern."""
    about: dict[PartName, list[RuleWatch]] = {}
    for rule in rules:
        for part in {rule.system, rule.part}:
            about.setdefault(part, []).append(rule)
    return about
