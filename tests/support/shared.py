"""Conformance data that lies beside the checkout; tests over it are skipped where it is missing."""

import json
from pathlib import Path
from typing import Any

import pytest

PROJECT = Path(__file__).resolve().parents[2]
SHARED = PROJECT.parent / "shared"


def shared_folder(name: str) -> Path:
    """Return the folder `name` of the shared data, or skip the test that asks for it.

    Args:
        name: Path below the shared folder, as in `conformance/polaris`.
    """
    folder = SHARED / name
    if not folder.is_dir():
        pytest.skip(missing(name))
    return folder


def json_cases(name: str, pattern: str, key: str) -> list[object]:
    """List the named cases of JSON files, one parameter set each, for `pytest.mark.parametrize`.

    Args:
        name: Folder below the shared folder, as in `conformance/polaris/vectors`.
        pattern: Glob of the files in it.
        key: Member of a file's object that holds the list of cases; a case has a `name`.

    Returns:
        Sets whose id is `<file>:<case>`; one set that is skipped where the folder is missing.

    Raises:
        LookupError: The folder is there and holds no such case: the test would check nothing.
    """
    folder = SHARED / name
    if not folder.is_dir():
        return [pytest.param(None, id=name, marks=pytest.mark.skip(reason=missing(name)))]
    cases: list[object] = [
        pytest.param(case, id=f"{path.stem}:{case['name']}")
        for path in sorted(folder.glob(pattern))
        for case in _cases(path, key)
    ]
    if not cases:
        raise LookupError(f"no {key!r} in {pattern} of {name}")
    return cases


def missing(name: str) -> str:
    """Say why a test over the shared folder `name` is skipped."""
    return f"shared data {name!r} is not beside this checkout"


def _cases(path: Path, key: str) -> list[dict[str, Any]]:
    cases: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))[key]
    return cases
