"""Steps as small as they get: few at a time, they compress well only beside earlier ones.

A batch of one or two steps has little that repeats. So the first steps of a log are kept as the
dictionary of all later ones, in each file of its own; that halves the size of a log at rest.
"""

import zlib
from collections.abc import Sequence

DICTIONARY_BYTES = 8 * 2**10
_LEVEL = 1
_SEPARATOR = b"\n"
"""JSON writes it as an escape."""


def pack(steps: Sequence[bytes], dictionary: bytes) -> bytes:
    """Return lines as bytes; `dictionary` may be empty."""
    if not steps:
        return b""
    packing = zlib.compressobj(_LEVEL, zdict=dictionary) if dictionary else zlib.compressobj(_LEVEL)
    return packing.compress(_SEPARATOR.join(steps)) + packing.flush()


def unpack(packed: bytes, dictionary: bytes) -> list[bytes]:
    """Return the lines that `pack` was given with the same dictionary.

    Raises:
        zlib.error: It is damaged, or the dictionary is another one.
    """
    if not packed:
        return []
    unpacking = zlib.decompressobj(zdict=dictionary) if dictionary else zlib.decompressobj()
    return (unpacking.decompress(packed) + unpacking.flush()).split(_SEPARATOR)


class DictionaryMaker:
    """Gathers the first steps of a log, until there are enough for a dictionary."""

    def __init__(self) -> None:
        self._seen = b""

    def see(self, steps: Sequence[bytes]) -> bytes:
        """Take steps in; return the dictionary, or nothing as long as there are too few."""
        self._seen += _SEPARATOR.join(steps)
        if len(self._seen) < DICTIONARY_BYTES:
            return b""
        return self._seen[-DICTIONARY_BYTES:]
