"""Whether the packages that run are those of Pilothouse, and which version that is.

`api`, `domain` and `service` are common names. Where another distribution brings a package of the
same name into an environment, one overwrites or hides the other, and what fails then is some import
that nobody can explain.
"""

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

DISTRIBUTION = "pilothouse"
PACKAGES = ("api", "domain", "service", "web")

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
    ensure_unclaimed(metadata.packages_distributions())


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


def ensure_unclaimed(owners: Mapping[str, Sequence[str]]) -> None:
    """Check that no other distribution has installed a package of the same name.

    Args:
        owners: Distributions by top-level package, as of `importlib.metadata`.

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
