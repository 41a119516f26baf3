"""How much of each module of the core its own test file reaches; run by `make coverage`.

Reads what one run of the tests recorded with a context per test. A module that only the tests of
others reach breaks without one of its own failing, and the total does not show that.
"""

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from coverage import Coverage

PROJECT = Path(__file__).resolve().parents[2]
PACKAGE = PROJECT / "domain"
LEAST_PERCENT = 95.0
IMPORT = "^$"
"""Context of what runs when a module is imported, and so in every test."""


@dataclass(frozen=True, slots=True)
class Reach:
    """What was run of some code: statements and branches, counted together."""

    total: int
    reached: int
    missing: str = ""
    """Line numbers of statements that never ran, and of branches that never went one way."""

    @property
    def percent(self) -> float:
        """Return the share that was run, in %; 100 where there is nothing to run."""
        return 100.0 * self.reached / self.total if self.total else 100.0


def reach_of(module: Path, measured: Coverage, contexts: list[str] | None = None) -> Reach:
    """Return what was run of a module.

    Args:
        module: A source file.
        measured: A run with branches, loaded.
        contexts: Only what ran in contexts that these expressions match; None: in any.
    """
    measured.get_data().set_query_contexts(contexts)
    _, statements, _, missed, _ = measured.analysis2(str(module))
    branches = measured.branch_stats(str(module))
    one_way = {
        line for line, (ways, gone) in branches.items() if gone < ways and line not in missed
    }
    total = len(statements) + sum(ways for ways, _ in branches.values())
    reached = len(statements) - len(missed) + sum(gone for _, gone in branches.values())
    return Reach(total, reached, ", ".join(map(str, sorted({*missed, *one_way}))))


def own_contexts(module: Path, project: Path = PROJECT) -> list[str]:
    """Return the contexts of the tests in the file that mirrors a module, and that of imports."""
    test_file = Path("tests/unit") / module.relative_to(project).with_name(f"test_{module.name}")
    return [IMPORT, f"^{re.escape(test_file.as_posix())}::"]


def _findings(measured: Coverage) -> Iterator[str]:
    modules = sorted(PACKAGE.rglob("*.py"))
    all_of_them = [reach_of(module, measured) for module in modules]
    total = sum(reach.total for reach in all_of_them)
    whole = Reach(total, sum(reach.reached for reach in all_of_them))
    print(f"{PACKAGE.name}: {whole.percent:.1f} % of {whole.total} statements and branches")
    if whole.percent < LEAST_PERCENT:
        yield f"{whole.percent:5.1f} %  all tests together"
    for module in modules:
        own = reach_of(module, measured, own_contexts(module))
        if own.percent < LEAST_PERCENT:
            yield f"{own.percent:5.1f} %  {module.relative_to(PROJECT)}: {own.missing}"


def main() -> int:
    """Print the modules that are reached too little; return 1 if there are any."""
    measured = Coverage(config_file=str(PROJECT / "pyproject.toml"))
    measured.load()
    findings = list(_findings(measured))
    if findings:
        print(f"Below {LEAST_PERCENT:g} % by the test file of the module alone; lines missed:")
        print("\n".join(findings))
        return 1
    print(f"Each module is reached to at least {LEAST_PERCENT:g} % by its own test file.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
