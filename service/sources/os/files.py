"""What the kernel tells in files: pressure, and tables of keys and numbers."""

from pathlib import Path

from service.sources.source import SourceError


def pressure_percent(path: Path) -> float:
    """Return in which share of the last 10 s at least one task waited for a resource.

    Source: Linux, Documentation/accounting/psi.rst.

    Raises:
        OSError: The kernel has no pressure file there, or it is switched off.
        SourceError: It is not what it should be.
    """
    for line in path.read_text().splitlines():
        kind, *pairs = line.split()
        if kind == "some":
            return float(dict(pair.split("=", 1) for pair in pairs)["avg10"])
    raise SourceError(f"{path} tells no pressure")


def numbers_in(path: Path) -> dict[str, int]:
    """Return a table of a key and a number per line.

    Raises:
        OSError: The file cannot be read.
    """
    pairs = (line.split() for line in path.read_text().splitlines())
    return {pair[0]: int(pair[1]) for pair in pairs}
