from importlib.metadata import Distribution, distributions, packages_distributions
from pathlib import Path

import pytest

from api.distribution import (
    PACKAGES,
    ForeignPackageError,
    check_packages,
    ensure_together,
    ensure_unclaimed,
    installed_version,
    owners_of_packages,
)

HOME = Path("/venv/site-packages")


def installed(folder: Path, **files: str) -> list[Distribution]:
    """Return the distribution `whois-tools`, as it lies in a folder with these files."""
    home = folder / "whois_tools-1.0.dist-info"
    home.mkdir()
    (home / "METADATA").write_text("Metadata-Version: 2.1\nName: whois-tools\nVersion: 1.0\n")
    for name, text in files.items():
        (home / name.replace("_txt", ".txt")).write_text(text)
    return list(distributions(path=[str(folder)]))


def test_our_own_packages_pass() -> None:
    check_packages()


def test_the_version_is_that_of_the_installed_distribution() -> None:
    assert installed_version().count(".") == 2


def test_packages_side_by_side_belong_together() -> None:
    ensure_together(HOME, [(package, HOME) for package in PACKAGES])


def test_a_package_that_hides_ours_is_named_with_its_place() -> None:
    folders = [("api", HOME), ("domain", Path("/elsewhere"))]

    with pytest.raises(ForeignPackageError, match=r"'domain'.* lies in /elsewhere.*own") as refused:
        ensure_together(HOME, folders)

    assert refused.value.package == "domain"


def test_a_package_that_is_missing_is_named() -> None:
    with pytest.raises(ForeignPackageError, match=r"'service'.*missing"):
        ensure_together(HOME, [("service", None)])


def test_a_package_that_somebody_else_installed_over_ours_is_named_with_the_culprit() -> None:
    with pytest.raises(ForeignPackageError, match=r"'domain'.*'whois-tools' has installed"):
        ensure_unclaimed({"domain": ["pilothouse", "whois-tools"]})


def test_other_distributions_may_install_what_they_like() -> None:
    ensure_unclaimed({"domain": ["pilothouse"], "numpy": ["numpy"]})


@pytest.mark.parametrize(
    "recorded", ["domain/__init__.py,sha256=a,1", "domain/text/names.py,,", "domain.py,,"]
)
def test_who_recorded_a_file_in_a_package_owns_it(recorded: str, tmp_path: Path) -> None:
    others = installed(tmp_path, RECORD=f"whois_tools-1.0.dist-info/METADATA,,\n{recorded}\n")

    assert owners_of_packages(others) == {"domain": ["whois-tools"]}


@pytest.mark.parametrize(
    "recorded",
    ["domains/__init__.py,,", "whois/domain/__init__.py,,", "domain/text.json,,", "domain.txt,,"],
)
def test_who_recorded_something_else_does_not(recorded: str, tmp_path: Path) -> None:
    assert owners_of_packages(installed(tmp_path, RECORD=f"{recorded}\n")) == {}


def test_what_a_distribution_declares_is_not_looked_up(tmp_path: Path) -> None:
    others = installed(tmp_path, RECORD="domain/__init__.py,,\n", top_level_txt="web\nwhois\n")

    assert owners_of_packages(others) == {"web": ["whois-tools"]}


def test_a_distribution_without_files_owns_nothing(tmp_path: Path) -> None:
    assert owners_of_packages(installed(tmp_path)) == {}


def test_the_library_finds_the_same_owners_here() -> None:
    everybody = packages_distributions()

    assert owners_of_packages(distributions()) == {
        package: everybody[package] for package in PACKAGES if package in everybody
    }
