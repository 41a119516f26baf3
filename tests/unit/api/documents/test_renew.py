"""The documents that are checked in are those that the service gives."""

from pathlib import Path

import pytest

from api.documents.renew import documents, renew
from tests.support.shared import PROJECT

REFERENCE = PROJECT / "docs" / "reference"


@pytest.mark.parametrize("name", ["openapi.json", "asyncapi.json"])
def test_what_is_checked_in_is_up_to_date(name: str) -> None:
    is_same = (REFERENCE / name).read_text(encoding="utf-8") == documents()[name]

    assert is_same, "renew it with: python -m api.documents.renew"


def test_they_are_written_to_a_folder(tmp_path: Path) -> None:
    renew(tmp_path)

    assert {path.name for path in tmp_path.iterdir()} == set(documents())
