"""Whether the packages that run are those of Pilothouse, and which version that is.

`api`, `domain` and `service` are common names. Where another distribution brings a package of the
same name into an environment, one overwrites or hides the other, and what fails then is some import
that nobody can explain.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

DISTRIBUTION = "pilothouse"
PACKAGES = ("api", "domain", "service", "web")

_NAMES = "|".join(PACKAGES)
# A line of a RECORD with a module of ours, or with a file inside a package of ours.
_RECORDED = re.compile(rf'^"?({_NAMES})(?:/.*)?\.py"?,', re.MULTILINE)

_CURE = "install Pilothouse in an environment of its own: uv tool, pipx or a venv"


class ForeignPackageError(Exception):
    """A package that Pilothouse would import does not come from its own distribution."""

    def __init__(self, package: str, where: str) -> None:
        super().__init__(f"the package {package!r} is not that of Pilothouse: {where}; {_CURE}")
        self.package = package


@cache
def installed_version() -> str:
    """Return the version of the installed distribution."""
    try:
        return metadata.version(DISTRIBUTION)
    except metadata.PackageNotFoundError:
        return "not installed"


def check_packages() -> None:
    """Check that all packages lie beside this one, and that no other distribution claims them.

    Raises:
        ForeignPackageError: Naming the first that does not.
    """
    ensure_together(Path(__file__).resolve().parents[1], map(_folder_of, PACKAGES))
    ensure_unclaimed(owners_of_packages(metadata.distributions()))


def ensure_together(home: Path, folders: Iterable[tuple[str, Path | None]]) -> None:
    """Check that each package lies in `home`.

    Raises:
        ForeignPackageError: One lies elsewhere, or nowhere.
    """
    for package, folder in folders:
        if folder is None:
            raise ForeignPackageError(package, "it is missing")
        if folder != home:
            raise ForeignPackageError(package, f"it lies in {folder}, the others in {home}")


def owners_of_packages(distributions: Iterable[metadata.Distribution]) -> Mapping[str, list[str]]:
    """Return the names of the distributions that bring packages of these names.

    As `importlib.metadata.packages_distributions`, which makes an object of each installed file and
    parses all metadata: with a hundred distributions that takes 0.1 s.
    """
    owners: dict[str, list[str]] = {}
    for each in distributions:
        declared = (each.read_text("top_level.txt") or "").split()
        found = declared or _RECORDED.findall(each.read_text("RECORD") or "")
        for package in set(found).intersection(PACKAGES):
            owners.setdefault(package, []).append(each.metadata["Name"])
    return owners


def ensure_unclaimed(owners: Mapping[str, Sequence[str]]) -> None:
    """Check that no other distribution has installed a package of the same name.

    Args:
        owners: Distributions by top-level package, as of `owners_of_packages`.

    Raises:
        ForeignPackageError: One has.
    """
    for package in PACKAGES:
        for owner in owners.get(package, ()):
            if owner != DISTRIBUTION:
                raise ForeignPackageError(package, f"{owner!r} has installed one as well")


def _folder_of(package: str) -> tuple[str, Path | None]:
    spec = find_spec(package)
    if spec is None or spec.origin is None:
        return package, None
    return package, Path(spec.origin).resolve().parents[1]
