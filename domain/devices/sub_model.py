"""The part of a model that a device runs: its own nodes, and all that rests on these alone."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace

from domain.changes.plan import targets_of
from domain.conditions.check import Fault, terms_of
from domain.conditions.condition import Condition
from domain.conditions.tree import TopicKind, comparisons
from domain.conditions.vocabulary import Vocabulary
from domain.health.signals import STALE_DATA, SignalSettings
from domain.lifecycle import LifecycleState
from domain.parts.declared_errors import DeclaredError
from domain.parts.declared_reactions import DeclaredReaction
from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.reaction_terms import Action
from domain.robot_vocabulary import vocabulary_of
from domain.snapshot import ErrorKey
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode

_OF_THE_SUPERVISOR = frozenset({TopicKind.ROBOT, TopicKind.TASK, TopicKind.VEHICLE, TopicKind.HOLD})
_OF_THE_TASK = frozenset({Action.HOLD, Action.STOP})


@dataclass(frozen=True, slots=True)
class LeftOut:
    """What a device does not do of what the model says about its parts."""

    what: str
    reason: str

    @property
    def words(self) -> str:
        """Return it in one sentence."""
        return f"{self.what}: {self.reason}"


@dataclass(frozen=True, slots=True)
class SubModel:
    """The part of a model that is a device's own."""

    model: SmhModel
    left_out: tuple[LeftOut, ...]
    unguarded: Mapping[tuple[PartName, ModeName], str] = field(default_factory=dict)
    """Modes with guards that the device cannot judge, each with what these rest on."""

    def unjudged(self, part: PartName, target: StateAndMode) -> str | None:
        """Return why a device must not pursue a target of its own accord; None: it may."""
        if not self.unguarded:
            return None
        for below, wanted in targets_of(self.model, part, target).items():
            mode = wanted.mode or DEFAULT_MODE
            rests_on = self.unguarded.get((below, mode))
            if wanted.state is LifecycleState.ACTIVE and rests_on is not None:
                return f"whether {below} may be in {mode} rests on {rests_on}"
        return None


def sub_model(
    model: SmhModel, nodes: Collection[PartName], signals: Iterable[SignalSettings]
) -> SubModel:
    """Return what of a model is a device's own.

    Args:
        model: Of the whole robot.
        nodes: Those of the device.
        signals: Those that are read there, with monitors of them.
    """
    return _Cut(model, nodes, tuple(signals)).sub_model()


@dataclass(slots=True)
class _Parts:
    """The parts that conditions can name."""

    nodes: Mapping[PartName, NodeModel]
    systems: Mapping[PartName, SystemModel]
    errors: dict[PartName, dict[str, DeclaredError]]


class _Cut:
    """Cuts a model down; what is left out may leave out more that rests on it."""

    def __init__(
        self, model: SmhModel, nodes: Collection[PartName], signals: tuple[SignalSettings, ...]
    ) -> None:
        self._model = model
        self._signals = signals
        self._left_out: list[LeftOut] = []
        own_nodes = {name: node for name, node in model.nodes.items() if name in nodes}
        systems = self._own_systems(own_nodes.keys())
        names = own_nodes.keys() | systems.keys()
        self._parts = _Parts(
            own_nodes,
            {name: self._with_own_rules(system, names) for name, system in systems.items()},
            {part: dict(own) for part, own in model.errors.items() if part in names},
        )

    def sub_model(self) -> SubModel:
        self._cut_errors()
        vocabulary = self._vocabulary()
        settings, unguarded = self._settings(vocabulary)
        parts = self._parts
        # The guards of a target are needed to judge reactions, which need the parts.
        bare = SmhModel(parts.nodes, parts.systems)
        reactions = self._reactions(SubModel(bare, (), unguarded), vocabulary)
        model = SmhModel(parts.nodes, parts.systems, settings, parts.errors, reactions)
        return SubModel(model, tuple(self._left_out), unguarded)

    def _leave_out(self, what: str, reason: str) -> None:
        self._left_out.append(LeftOut(what, reason))

    # --- systems ---------------------------------------------------------------------------------

    def _own_systems(self, nodes: Collection[PartName]) -> dict[PartName, SystemModel]:
        """Return the systems all parts of which are own ones, in the order of the file."""
        own = set(nodes)
        waiting = dict(self._model.systems)
        while True:
            found = [
                name
                for name, system in waiting.items()
                if system.named_parts and own.issuperset(system.named_parts)
            ]
            if not found:
                break
            own.update(found)
            for name in found:
                del waiting[name]
        return {name: system for name, system in self._model.systems.items() if name in own}

    def _with_own_rules(self, system: SystemModel, own: Collection[PartName]) -> SystemModel:
        rules = tuple(rule for rule in system.rules if rule.if_part[0] in own)
        for rule in system.rules:
            if rule not in rules:
                what = f"rule {rule.name} of {system.name}"
                self._leave_out(what, f"{rule.if_part[0]} is not its own")
        return system if len(rules) == len(system.rules) else replace(system, rules=rules)

    # --- errors ----------------------------------------------------------------------------------

    def _vocabulary(self) -> Vocabulary:
        """Return what conditions can name at the device; stale data may be that of any signal."""
        known = vocabulary_of(self._parts, self._signals, is_complete=True)
        return replace(known, errors=tuple(name for name in known.errors if name != STALE_DATA))

    def _cut_errors(self) -> None:
        """Leave out errors that are not found at the device, until no more rest on them."""
        has_more, vocabulary = True, self._vocabulary()
        while has_more:
            has_more, vocabulary = False, self._vocabulary()
            for part, own in self._parts.errors.items():
                for name, error in list(own.items()):
                    reason = _why_not_found(error, vocabulary)
                    if reason is not None:
                        self._leave_out(f"error {name} of {part}", reason)
                        del own[name]
                        has_more = True
        self._parts.errors = {
            part: {name: _with_own_causes(error, vocabulary) for name, error in own.items()}
            for part, own in self._parts.errors.items()
            if own
        }

    # --- guards ----------------------------------------------------------------------------------

    def _settings(
        self, vocabulary: Vocabulary
    ) -> tuple[
        dict[PartName, Mapping[ModeName, ModeSettings]], dict[tuple[PartName, ModeName], str]
    ]:
        settings: dict[PartName, Mapping[ModeName, ModeSettings]] = {}
        unguarded: dict[tuple[PartName, ModeName], str] = {}
        for part, by_mode in self._model.mode_settings.items():
            if part not in self._parts.nodes and part not in self._parts.systems:
                continue
            settings[part] = {
                mode: replace(
                    own,
                    requires=_own(own.requires, vocabulary),
                    invariants=_own(own.invariants, vocabulary),
                )
                for mode, own in by_mode.items()
            }
            foreign: dict[str, str] = {}
            for mode in self._model.modes_of(part):
                for guard in self._model.settings_of(part, mode).guards:
                    fact = _foreign(guard, vocabulary)
                    if fact is not None:
                        foreign[guard.text] = unguarded[part, mode] = fact
            for text, fact in foreign.items():
                self._leave_out(f"guard of {part}, {text}", f"{fact} is not its own")
        return settings, unguarded

    # --- reactions -------------------------------------------------------------------------------

    def _reactions(
        self, own: SubModel, vocabulary: Vocabulary
    ) -> dict[PartName, dict[str, DeclaredReaction]]:
        """Return the reactions whose conditions and targets are all the device's own."""
        kept: dict[str, DeclaredReaction] = {}
        for part, declared in self._model.reactions.items():
            for name, reaction in declared.items() if part in own.model else ():
                reason = _why_not_own(reaction, own, vocabulary)
                if reason is None:
                    kept[name] = reaction
                else:
                    self._leave_out(f"reaction {name} of {part}", reason)
        while True:
            lost = [r for r in kept.values() if r.escalation and r.escalation.to not in kept]
            for reaction in lost:
                assert reaction.escalation is not None
                reason = f"it escalates to {reaction.escalation.to}, which is not its own"
                self._leave_out(f"reaction {reaction.name} of {reaction.part}", reason)
                del kept[reaction.name]
            if not lost:
                break
        found: dict[PartName, dict[str, DeclaredReaction]] = {}
        for reaction in kept.values():
            found.setdefault(reaction.part, {})[reaction.name] = reaction
        return found


def _own(guards: Iterable[Condition], vocabulary: Vocabulary) -> tuple[Condition, ...]:
    return tuple(guard for guard in guards if _foreign(guard, vocabulary) is None)


def _foreign(condition: Condition | None, vocabulary: Vocabulary) -> str | None:
    """Return the first fact of a condition that a device does not know itself; None: none."""
    if condition is None:
        return None
    for leaf in comparisons(condition.root):
        subject = leaf.subject
        if subject.topic.kind in _OF_THE_SUPERVISOR:
            return subject.text
        terms = terms_of(subject, vocabulary)
        if isinstance(terms, Fault) and terms.severity == "error":
            return subject.text
    return None


def _why_not_found(error: DeclaredError, vocabulary: Vocabulary) -> str | None:
    """Return why an error of an own part is not found at the device; None: it is."""
    foreign = _foreign(error.when, vocabulary)
    if foreign is None and error.when is None:
        foreign = _foreign(error.unless, vocabulary)
    if foreign is not None:
        return f"{foreign} is not its own"
    if error.when is None:
        for cause in error.caused_by:
            if not _is_known(cause, vocabulary):
                return f"its cause {cause.name} is not its own"
    return None


def _with_own_causes(error: DeclaredError, vocabulary: Vocabulary) -> DeclaredError:
    """Return an error that is explained, and suppressed, by what the device knows."""

    def own(condition: Condition | None) -> Condition | None:
        return condition if _foreign(condition, vocabulary) is None else None

    return replace(
        error,
        caused_by=tuple(cause for cause in error.caused_by if _is_known(cause, vocabulary)),
        unless=own(error.unless),
        suppressed_when=own(error.suppressed_when),
    )


def _is_known(cause: ErrorKey, vocabulary: Vocabulary) -> bool:
    if cause.part is None:
        return cause.error in vocabulary.errors
    part = vocabulary.parts.get(cause.part)
    return part is not None and cause.error in part.errors


def _why_not_own(reaction: DeclaredReaction, own: SubModel, vocabulary: Vocabulary) -> str | None:
    """Return why a reaction of an own part is the supervisor's; None: it is the device's."""
    if reaction.action in _OF_THE_TASK:
        return f"its action {reaction.action} is about the task, which is the supervisor's"
    if reaction.action is Action.TELL:
        return "it only tells, as the supervisor does"
    if reaction.action is Action.RESTART:
        return "it leads back to a target, which the supervisor knows"
    foreign = _foreign(reaction.when, vocabulary)
    if foreign is not None:
        return f"{foreign} is not its own"
    if reaction.target is not None:
        return own.unjudged(reaction.part, reaction.target)
    return None
