"""Says scripts and style sheets in fewer characters, by a library that parses them.

The library is a program of its own inside a shared object of 7 MB. A process of its own loads it,
for half a second at the start, so that the service does not have it in its memory. There is no such
library for every machine: without it the page is the same, and a fifth larger.
"""

import json
import logging
import subprocess
import sys
from collections.abc import Mapping
from importlib.util import find_spec

_LIBRARY = "minify"
_KINDS = {"js": "application/javascript", "css": "text/css"}
_PATIENCE_S = 30.0

log = logging.getLogger(__name__)


def minified(texts: Mapping[str, str]) -> Mapping[str, str]:
    """Return the texts, shorter if that is possible here.

    Args:
        texts: By name; what is neither script nor style sheet stays as it is.
    """
    if find_spec(_LIBRARY) is None:
        return texts
    command = [sys.executable, "-I", "-m", __name__]
    try:
        ended = subprocess.run(
            command, input=json.dumps(texts).encode(), capture_output=True, timeout=_PATIENCE_S
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        log.warning("the page is served as it is written: %s", error)
        return texts
    if ended.returncode:
        log.warning("the page is served as it is written: %s", ended.stderr.decode()[-500:])
        return texts
    shorter: dict[str, str] = json.loads(ended.stdout)
    return shorter


def _minify_all() -> None:
    """Be the process: read texts, and write them shorter."""
    import minify

    texts: dict[str, str] = json.load(sys.stdin)
    for name, text in texts.items():
        kind = _KINDS.get(name.rpartition(".")[2])
        if kind is not None:
            texts[name] = minify.string(kind, text)
    json.dump(texts, sys.stdout)


if __name__ == "__main__":
    _minify_all()
