"""How many of the changes that mutmut made to the core were noticed; run by `make mutation`."""

import subprocess
import sys
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

LEAST_PERCENT = 85.0
NOTICED = ("killed", "timeout", "caught by type check")
_COLUMNS = ("killed", "timeout", "survived", "no tests", "suspicious")


@dataclass(slots=True)
class Score:
    """How the mutants of some code ended, by the words of mutmut."""

    ends: Counter[str] = field(default_factory=Counter)

    @property
    def percent(self) -> float:
        """Return the share of mutants that were noticed, in %; 100 where there are none."""
        total = self.ends.total()
        return 100.0 * sum(self.ends[end] for end in NOTICED) / total if total else 100.0

    def line(self, name: str) -> str:
        """Return a line of the table."""
        counts = "".join(f"{self.ends[column]:>11}" for column in _COLUMNS)
        return f"{name:<32}{self.ends.total():>8}{counts}{self.percent:>8.1f} %"


def scores(results: Iterable[str]) -> dict[str, Score]:
    """Return the score of each module.

    Args:
        results: Lines of `mutmut results --all true`, as in
            `domain.lifecycle.x_arrival__mutmut_1: killed`.
    """
    found: dict[str, Score] = {}
    for line in results:
        mutant, colon, end = line.strip().partition(": ")
        module, dot, _ = mutant.rpartition(".")
        if colon and dot:
            found.setdefault(module, Score()).ends[end] += 1
    return found


def main() -> int:
    """Print the scores; return 1 if that of all is too low, or if a mutant was never run."""
    mutmut = Path(sys.executable).with_name("mutmut")
    listed = subprocess.run(
        [mutmut, "results", "--all", "true"], check=True, capture_output=True, text=True
    )
    modules = scores(listed.stdout.splitlines())
    whole = Score(sum((score.ends for score in modules.values()), Counter()))
    print(f"{'':<32}{'mutants':>8}" + "".join(f"{column:>11}" for column in _COLUMNS))
    for name, score in sorted(modules.items()):
        print(score.line(name))
    print(whole.line("all"))
    if whole.ends["not checked"] or not modules:
        print("There are mutants that were not run.")
        return 1
    if whole.percent < LEAST_PERCENT:
        print(f"Below {LEAST_PERCENT:g} %; `mutmut results` lists the survivors.")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
