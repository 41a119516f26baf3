"""The number in the bytes of a register."""

from service.files.source_block import RegisterBlock
from service.sources.source import SourceError


def number_in(data: bytes, block: RegisterBlock) -> float:
    """Return the number that a register holds, with scale and offset.

    Args:
        data: The bytes as they were read.
        block: Says what they mean.

    Raises:
        SourceError: There are more or fewer bytes than the number has.
    """
    if len(data) != block.size_bytes:
        raise SourceError(f"{len(data)} bytes were read instead of {block.size_bytes}")
    bits = 8 * block.size_bytes - block.shift if block.bits is None else block.bits
    number = int.from_bytes(data, block.order) >> block.shift & ((1 << bits) - 1)
    if block.signed and number >> (bits - 1):
        number -= 1 << bits
    return number * block.scale + block.offset
