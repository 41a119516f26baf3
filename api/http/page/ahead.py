"""What was minified before the first start, for an installation without the library.

It stands beside this module; an image is built so, since the library would be a twentieth of it.
"""

import hashlib
import json
import logging
from collections.abc import Mapping
from pathlib import Path

log = logging.getLogger(__name__)


def kept(texts: Mapping[str, str], file: Path | None = None) -> Mapping[str, str] | None:
    """Return what was made ahead of these texts; None: nothing, or of other texts.

    Args:
        texts: The bundles of the page, by name.
        file: Where it is kept; None: beside this module.
    """
    file = file or beside()
    try:
        found = json.loads(file.read_bytes())
        made: dict[str, str] = found["texts"]
        is_of_these = found["of"] == _digest(texts)
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError) as error:
        log.warning("%s cannot be read: %s", file, error)
        return None
    return made if is_of_these else None


def keep(texts: Mapping[str, str], made: Mapping[str, str], file: Path | None = None) -> Path:
    """Write what was made of the texts; return where."""
    file = file or beside()
    file.write_text(json.dumps({"of": _digest(texts), "texts": dict(made)}), encoding="utf-8")
    return file


def beside() -> Path:
    """Return where an installation keeps it."""
    return Path(__file__).with_name("minified.json")


def _digest(texts: Mapping[str, str]) -> str:
    return hashlib.sha256(json.dumps(dict(texts), sort_keys=True).encode()).hexdigest()
