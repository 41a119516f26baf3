from pathlib import Path

import pytest

from api.distribution import (
    PACKAGES,
    ForeignPackageError,
    check_packages,
    ensure_together,
    ensure_unclaimed,
    installed_version,
)

HOME = Path("/venv/site-packages")


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
