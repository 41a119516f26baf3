"""The signals whose readings are kept: their numbers, and their values and errors as numbers.

A signal whose type or unit changes is another one: its values would not merge with the earlier
ones. Those remain in the file until they are old.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from threading import Lock

from domain.health.signals import SignalKind, SignalSettings
from domain.inputs import SignalValue
from service.storage.trends.rows import NO_ERROR


@dataclass(slots=True)
class KnownSignal:
    """One signal, or one of an earlier run that is declared no longer."""

    number: int
    """In memory; in the file, it has another one."""
    identity: str
    codes: Mapping[str, int] = field(default_factory=dict)
    """Of the members of an enumeration, from good to bad; empty: it is none."""
    ranks: dict[str, int] = field(default_factory=dict)
    """Of its errors: the worse, the higher."""
    _lock: Lock = field(default_factory=Lock)

    def number_of(self, value: SignalValue) -> float:
        """Return a value as a number: a boolean as 0 or 1, a member as its place."""
        return self.codes[value] if isinstance(value, str) else value

    def value_of(self, number: float) -> float | str:
        """Return what `number_of` made a number of; a boolean stays a number."""
        return list(self.codes)[round(number)] if self.codes else number

    def rank_of(self, error: str | None) -> int:
        """Return the rank of an error; one that is declared no longer is below all others."""
        if error is None:
            return NO_ERROR
        rank = self.ranks.get(error)
        if rank is None:
            with self._lock:
                unknown = sum(rank < 0 for rank in self.ranks.values())
                rank = self.ranks.setdefault(error, -1 - unknown)
        return rank

    def errors_of(self, ranks: Iterable[int]) -> list[str]:
        """Return the errors of ranks, without `NO_ERROR`."""
        names = {rank: error for error, rank in self.ranks.items()}
        return [names[rank] for rank in ranks if rank != NO_ERROR]


class KnownSignals:
    """All of them, by name and by number."""

    def __init__(self, signals: Iterable[SignalSettings]) -> None:
        self._all = [_known(number, settings) for number, settings in enumerate(signals)]
        self.by_name = {json.loads(known.identity)[0]: known for known in self._all}
        """Those that are declared."""

    def __getitem__(self, number: int) -> KnownSignal:
        return self._all[number]

    @property
    def identities(self) -> Sequence[str]:
        """Return the identities by number."""
        return [known.identity for known in self._all]

    def add(self, identities: Iterable[str]) -> None:
        """Add those signals of a file that are not declared, so that their history goes on."""
        missing = set(identities) - set(self.identities)
        for identity in sorted(missing):
            self._all.append(KnownSignal(len(self._all), identity))


def _known(number: int, settings: SignalSettings) -> KnownSignal:
    spec = settings.spec
    members = spec.members if spec.kind is SignalKind.ENUMERATION else ()
    identity = json.dumps([spec.name, spec.kind, spec.unit, members])
    errors = list(settings.value_errors)
    return KnownSignal(
        number,
        identity,
        {member: code for code, member in enumerate(members)},
        {error: rank for rank, error in enumerate(reversed(errors))},
    )
