"""Files that hold one number, as those of hwmon, thermal and IIO in /sys."""

import os
from collections.abc import Mapping
from glob import glob, has_magic

from domain.timebase import seconds
from service.clock import Clock
from service.files.source_block import FileBlock
from service.sources.sampled import Probe, SampledSource
from service.sources.source import SourceError

_LONGEST = 64
"""Longest text of a number, in bytes; no more of the file is read."""


def file_source(clock: Clock, path: str, blocks: Mapping[str, FileBlock]) -> SampledSource:
    """Return the source of one file.

    Args:
        clock: Of the service.
        path: Of the file.
        blocks: What is read from it, by signal.
    """
    probes = [
        Probe(signal, seconds(block.period_s), NumberFile(block).read)
        for signal, block in blocks.items()
    ]
    return SampledSource(f"file {path}", probes, clock)


class NumberFile:
    """One file, opened anew for each reading: drivers come and go, and renumber their files."""

    def __init__(self, block: FileBlock) -> None:
        self._block = block

    def read(self) -> float:
        """Return the number, with scale and offset.

        Raises:
            OSError: The file cannot be read.
            SourceError: It does not hold one number, or not exactly one file matches.
        """
        return self._number() * self._block.scale + self._block.offset

    def _number(self) -> float:
        # Not to wait for the writer of a pipe.
        descriptor = os.open(self._path(), os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        try:
            text = os.read(descriptor, _LONGEST + 1)
        finally:
            os.close(descriptor)
        try:
            if len(text) > _LONGEST:
                raise ValueError
            return float(text)
        except ValueError:
            raise SourceError(f"holds {text[:20]!r} and not a number") from None

    def _path(self) -> str:
        path = self._block.path
        if not has_magic(path):
            return path
        found = glob(path)
        if len(found) != 1:
            raise SourceError(f"{len(found)} files match {path}")
        return found[0]
