"""The other side of `service.worker`: take one job after the other from standard input, for ever.

Messages are pickles. Only `service.worker` writes here, and it writes only functions of this
program and their arguments.
"""

import importlib
import os
import pickle
import struct
import sys
import traceback
from collections.abc import Sequence
from typing import Any, BinaryIO, Literal, NamedTuple

from domain.errors import PilothouseError

MEMORY_LIMIT_BYTES = 2 * 1024**3
"""Of addresses. Above it a job ends in a MemoryError, and the robot's other processes live on."""

_NICENESS = 5
_LENGTH = struct.Struct("!Q")
LENGTH_BYTES = _LENGTH.size


class Reply(NamedTuple):
    """What became of a job."""

    outcome: Literal["done", "refused", "failed"]
    value: object
    """Done: what it returned. Refused: the error. Failed: the traceback as text."""


class ErrorParcel(NamedTuple):
    """An error of our own on its way; their constructors take other arguments than they keep."""

    kind: type[PilothouseError]
    message: str
    facts: dict[str, object]

    @classmethod
    def of(cls, error: PilothouseError) -> "ErrorParcel":
        """Pack `error`."""
        return cls(type(error), error.message, vars(error))

    def unpacked(self) -> PilothouseError:
        """Return the error as it was raised."""
        error = self.kind.__new__(self.kind)
        error.args = (self.message,)
        vars(error).update(self.facts)
        return error


def large(value: object) -> object:
    """Return bytes such that they are sent beside the pickle and not copied into it."""
    return pickle.PickleBuffer(value) if isinstance(value, bytes) else value


def pack(message: object) -> list[bytes | memoryview]:
    """Return a message as it is sent, in pieces: nothing large is copied.

    First the number of pieces that follow, then the length of each, then they themselves: a pickle,
    and what lies beside it, such as a body or the numbers of a path.
    """
    beside: list[pickle.PickleBuffer] = []
    data = pickle.dumps(message, protocol=5, buffer_callback=beside.append)
    pieces: list[bytes | memoryview] = [data, *(buffer.raw() for buffer in beside)]
    lengths = b"".join(number_of(len(piece)) for piece in pieces)
    return [number_of(len(pieces)) + lengths, *pieces]


def unpack(pieces: Sequence[bytes]) -> object:
    """Return a message of which all pieces are there."""
    message: object = pickle.loads(pieces[0], buffers=pieces[1:])
    return message


def number_of(value: int) -> bytes:
    """Return a number or length as it is sent."""
    return _LENGTH.pack(value)


def numbers_in(head: bytes) -> tuple[int, ...]:
    """Return the numbers or lengths in some bytes."""
    return tuple(number for (number,) in _LENGTH.iter_unpack(head))


def read(stream: BinaryIO) -> object | None:
    """Return the next message; None: it breaks off, or there is none."""
    head = stream.read(LENGTH_BYTES)
    if len(head) < LENGTH_BYTES:
        return None
    (count,) = numbers_in(head)
    lengths = numbers_in(stream.read(count * LENGTH_BYTES))
    return unpack([stream.read(length) for length in lengths])


def serve(jobs: BinaryIO, replies: BinaryIO) -> None:
    """Do jobs until there is nobody who could send more."""
    while (job := read(jobs)) is not None:
        for piece in pack(do(job)):
            replies.write(piece)
        replies.flush()


def do(job: Any) -> Reply:  # noqa: ANN401  # whatever `service.worker` sent
    """Do one job.

    Args:
        job: A function and its arguments.

    Raises:
        MemoryError: The job wants more than there is. What it left behind is unknown: the process
            has to end.
    """
    function, arguments = job
    try:
        return Reply("done", large(function(*arguments)))
    except PilothouseError as error:
        return Reply("refused", ErrorParcel.of(error))
    except MemoryError:
        raise
    except Exception:
        # The edge of this process: a fault in one job is told to whoever asked for it.
        return Reply("failed", traceback.format_exc())


def main() -> None:
    """Step back behind the robot's own work, import the modules in the arguments, then serve."""
    os.nice(_NICENESS)
    if sys.platform != "win32":
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_LIMIT_BYTES, MEMORY_LIMIT_BYTES))
    replies = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    # What a job prints must not end up between the replies.
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    for module in sys.argv[1:]:
        importlib.import_module(module)
    try:
        serve(sys.stdin.buffer, replies)
    except MemoryError:
        sys.exit("the worker ran out of memory")
