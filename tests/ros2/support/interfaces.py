"""The packages in examples/ros2/interfaces, built for the Python that runs the tests."""

import fcntl
import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.support.shared import PROJECT

EXAMPLES = PROJECT / "examples" / "ros2"
BUILD = EXAMPLES / "build_with_wheels.sh"
# Where the wheels of the tests are, which set this themselves; the build has its own.
OF_THE_WHEELS = "LD_LIBRARY_PATH"


def built_interfaces() -> Sequence[str]:
    """Return the variables that name the packages, as `NAME=value`.

    They are built unless they are there. Tests that run at the same time share one build.
    """
    missing = [tool for tool in ("cmake", "g++") if shutil.which(tool) is None]
    if missing and os.environ.get("CI") != "true":
        pytest.skip(f"the interfaces cannot be built: there is no {' and no '.join(missing)}")
    prefix = PROJECT / "build" / f"ros2-interfaces-{_sources_id()}"
    prefix.parent.mkdir(exist_ok=True)
    with prefix.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (prefix / "setup.sh").exists():
            _build(prefix)
    packages = next(prefix.glob("lib/python3*/site-packages"))
    return (
        f"AMENT_PREFIX_PATH={prefix}",
        f"LD_LIBRARY_PATH={prefix / 'lib'}:{os.environ[OF_THE_WHEELS]}",
        f"PYTHONPATH={packages}",
    )


def _sources_id() -> str:
    """Return what changes with any file that is built, and with the Python that it is for."""
    found = hashlib.sha256(sys.version.encode())
    for path in sorted([BUILD, *(EXAMPLES / "interfaces").rglob("*")]):
        if path.is_file():
            found.update(f"{path.relative_to(EXAMPLES)}\n".encode() + path.read_bytes())
    return found.hexdigest()[:12]


def _build(prefix: Path) -> None:
    environment = {k: v for k, v in os.environ.items() if k != OF_THE_WHEELS}
    done = subprocess.run(
        [BUILD, prefix],
        env={**environment, "PYTHON": sys.executable},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
