"""The documents that are checked in are those that the service gives."""

import re
from importlib.metadata import version
from pathlib import Path

import pytest
from packaging.version import Version

from api.documents.renew import documents, renew
from tests.support.shared import PROJECT

REFERENCE = PROJECT / "docs" / "reference"


LOCK = PROJECT / "requirements.lock"


def is_older_than_locked(package: str) -> bool:
    locked = re.search(rf"^{package}==(\S+)", LOCK.read_text(encoding="utf-8"), re.MULTILINE)
    assert locked is not None
    return Version(version(package)) < Version(locked[1])


@pytest.mark.skipif(
    is_older_than_locked("fastapi") or is_older_than_locked("pydantic"),
    reason="an older framework words its part of the documents otherwise",
)
@pytest.mark.parametrize("name", ["openapi.json", "asyncapi.json"])
def test_what_is_checked_in_is_up_to_date(name: str) -> None:
    is_same = (REFERENCE / name).read_text(encoding="utf-8") == documents()[name]

    assert is_same, "renew it with: make docs"


def test_they_are_written_to_a_folder(tmp_path: Path) -> None:
    renew(tmp_path)

    assert {path.name for path in tmp_path.iterdir()} == set(documents())
