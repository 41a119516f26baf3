"""npm's `ws`, installed below build/ when a bench asks for it."""

import shutil
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from tests.support.bench import RESULTS

_FOLDER = RESULTS / "node"
_PACKAGE = "ws@8"
_PATIENCE_S = 60


class NoNodeError(Exception):
    """It cannot be had here; the message says why."""


@dataclass(frozen=True, slots=True)
class NodeServer:
    """How to run the server of node."""

    command: tuple[str, ...]
    environment: Mapping[str, str]


def node_server() -> NodeServer:
    """Return how to run ws_server.cjs.

    Raises:
        NoNodeError: There is no node, no npm, or npm did not install the package.
    """
    node, npm = shutil.which("node"), shutil.which("npm")
    if node is None or npm is None:
        raise NoNodeError("there is no node, or no npm")
    modules = _FOLDER / "node_modules"
    if not (modules / "ws").is_dir():
        _FOLDER.mkdir(parents=True, exist_ok=True)
        install = (npm, "install", "--silent", "--no-audit", "--no-fund", "--prefix", _FOLDER)
        try:
            subprocess.run([*install, _PACKAGE], check=True, timeout=_PATIENCE_S)
        except (subprocess.SubprocessError, OSError) as error:
            raise NoNodeError(f"npm did not install {_PACKAGE}: {error}") from error
    script = Path(__file__).with_name("ws_server.cjs")
    return NodeServer((node, str(script)), {"NODE_PATH": str(modules)})
