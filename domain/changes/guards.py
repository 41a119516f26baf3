"""The guards of modes: what must be true for a part to enter a mode, and to stay in it."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Set
from dataclasses import replace
from itertools import chain

from domain.conditions.condition import Condition
from domain.conditions.evaluation import Truth
from domain.conditions.watched import WatchedConditions
from domain.findings import Blocker
from domain.lifecycle import LifecycleState
from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import SmhModel
from domain.state_and_mode import ModeName, PartName, StateAndMode
from domain.timebase import Duration, Instant

INVARIANT = "INVARIANT"


class Guards:
    """Judges guards by the facts of now: a guard holds only when it is true."""

    def __init__(self, model: SmhModel, watched: WatchedConditions, now: Instant) -> None:
        """Watch the guards of all modes.

        Args:
            model: Its modes have the guards.
            watched: Keeps conditions up to date.
            now: The current time.
        """
        self._model = model
        self._watched = watched
        self._of_parts = {
            part: tuple(dict.fromkeys(guard for own in modes.values() for guard in own.guards))
            for part, modes in model.mode_settings.items()
        }
        """The guards of all modes of each part, in the order of the model file."""
        self._parts_of: dict[str, list[PartName]] = {}
        """The parts that a guard belongs to, by its text."""
        for part, guards in self._of_parts.items():
            for guard in guards:
                self._parts_of.setdefault(guard.text, []).append(part)
        self._rank = {part: number for number, part in enumerate(self._of_parts)}
        self._changed = watched.follow(chain.from_iterable(self._of_parts.values()), now)
        self._changed.clear()
        every = chain.from_iterable(self._of_parts.values())
        self._failing = {g.text for g in every if watched.truth(g) is not Truth.TRUE}
        """The guards that are not known to be true."""
        self._moved: set[PartName] = set()
        """Parts of which a guard got another value since somebody asked for them."""

    @property
    def are_none(self) -> bool:
        """Tell whether no mode has a guard."""
        return not self._parts_of

    def failing(self, parts: Set[PartName]) -> list[PartName]:
        """Return the parts of which a guard, of any mode, is not true; in the order of the file.

        A large robot has many guards, of which most hold most of the time.
        """
        self._follow()
        texts, found = self._failing, parts
        if len(texts) < len(parts):
            found = parts & {part for text in texts for part in self._parts_of[text]}
        else:
            of_parts = self._of_parts
            found = {p for p in parts if any(g.text in texts for g in of_parts.get(p, ()))}
        return sorted(found, key=self._rank.__getitem__)

    def take_moved(self) -> set[PartName]:
        """Return the parts of which a guard got another value since the last call."""
        self._follow()
        moved, self._moved = self._moved, set()
        return moved

    def blockers(
        self, parts: Iterable[PartName], targets: Mapping[PartName, StateAndMode]
    ) -> Iterator[Blocker]:
        """Return why parts cannot enter their target modes; their paths begin with the part.

        Args:
            parts: Parts that have a target.
            targets: State and mode of each.
        """
        # Between two inputs all conditions are up to date, and most guards of a large robot hold.
        for part in parts:
            yield from self._blockers(part, targets[part], self._why_not)

    def blockers_of_step(
        self, parts: Iterable[PartName], targets: Mapping[PartName, StateAndMode]
    ) -> Iterator[Blocker]:
        """Return why parts cannot go on to their target modes: of invariants, without grace."""
        # The report that lets the step begin may be what breaks a guard.
        why_not = self._watched.explain if self._watched.may_have_changed else self._why_not
        for part in parts:
            has_grace = self._settings(part, targets[part]).grace > 0
            for blocker in self._blockers(part, targets[part], why_not):
                if not (has_grace and blocker.code == INVARIANT):
                    yield blocker

    def can_stay(self, part: PartName, mode: ModeName) -> bool:
        """Tell whether all invariants of a mode hold."""
        invariants = self._model.settings_of(part, mode).invariants
        return not any(self._why_not(condition) for condition in invariants)

    def broken(self, part: PartName, target: StateAndMode) -> tuple[Blocker, ...]:
        """Return which guards keep a part from a target, each with its reasons; empty: none."""
        return tuple(self.blockers((part,), {part: target}))

    def grace_of(self, part: PartName, target: StateAndMode) -> Duration:
        """Return how long an invariant of a target mode may be broken before it counts."""
        return self._settings(part, target).grace

    def fallback_of(self, part: PartName, target: StateAndMode) -> ModeName | None:
        """Return the mode that replaces a target mode whose invariants are broken; None: none."""
        return self._settings(part, target).fallback

    @property
    def revision(self) -> int:
        """Return a number that rises whenever a guard begins or ceases to hold."""
        return self._watched.revision

    def broken_for_too_long(
        self,
        parts: Iterable[PartName],
        targets: Mapping[PartName, StateAndMode],
        now: Instant,
        unknown_from: Instant = 0,
    ) -> tuple[Blocker | None, Instant | None]:
        """Look for an invariant of the target modes that is broken for longer than its grace.

        Args:
            parts: Parts that have a target.
            targets: State and mode of each.
            now: The current time.
            unknown_from: From when on an invariant that is unknown counts.

        Returns:
            Why one is; None: none is. And when the next one will be, if nothing changes.
        """
        due: Instant | None = None
        for part in parts:
            settings = self._settings(part, targets[part])
            for condition in settings.invariants:
                since = self._watched.broken_since(condition)
                if since is None:
                    continue
                at = since + settings.grace
                if self._watched.truth(condition) is Truth.UNKNOWN:
                    at = max(at, unknown_from)
                if at > now:
                    due = at if due is None else min(due, at)
                    continue
                causes = self._watched.explain(condition)
                for blocker in self._broken_invariant(part, targets[part].mode, condition, causes):
                    return blocker, None
        return None, due

    def _follow(self) -> None:
        """Take over which guards got another value."""
        for text, guard in self._changed.items():
            self._moved.update(self._parts_of[text])
            if self._watched.truth(guard) is Truth.TRUE:
                self._failing.discard(text)
            else:
                self._failing.add(text)
        self._changed.clear()

    def _settings(self, part: PartName, target: StateAndMode) -> ModeSettings:
        """Return the settings of the mode that a target enters; of none, the defaults."""
        if target.state is not LifecycleState.ACTIVE:
            return _UNGUARDED
        return self._model.settings_of(part, target.mode)

    def _why_not(self, condition: Condition) -> tuple[Blocker, ...]:
        """Return why a guard does not hold, unless it is known to; empty: it does."""
        is_true = self._watched.truth(condition) is Truth.TRUE
        return () if is_true else self._watched.explain(condition)

    def _blockers(
        self,
        part: PartName,
        target: StateAndMode,
        why_not: Callable[[Condition], tuple[Blocker, ...]],
    ) -> Iterator[Blocker]:
        settings = self._settings(part, target)
        for condition in settings.requires:
            for blocker in why_not(condition):
                yield replace(blocker, path=(part, *blocker.path))
        for condition in settings.invariants:
            yield from self._broken_invariant(part, target.mode, condition, why_not(condition))

    def _broken_invariant(
        self,
        part: PartName,
        mode: ModeName | None,
        condition: Condition,
        causes: tuple[Blocker, ...],
    ) -> Iterator[Blocker]:
        if causes:
            message = f"{part} cannot stay {mode or 'active'}: {causes[0].message}"
            yield Blocker(
                INVARIANT,
                message,
                (part,),
                since=causes[0].since,
                root_cause=False,
                causes=causes,
                condition=condition.text,
            )


_UNGUARDED = ModeSettings()
