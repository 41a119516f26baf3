"""The other side of `service.worker`: take one job after the other from standard input, for ever.

A message is a length and that many bytes of pickle. Only `service.worker` writes here, and it
writes only functions of this program and their arguments.
"""

import importlib
import os
import pickle
import struct
import sys
import traceback
from typing import BinaryIO, Literal, NamedTuple

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


def pack(message: object) -> bytes:
    """Return a message as it is sent: its length, then itself."""
    data = pickle.dumps(message)
    return _LENGTH.pack(len(data)) + data


def length_of(head: bytes) -> int:
    """Return how many bytes follow the first `LENGTH_BYTES` of a message."""
    length: int = _LENGTH.unpack(head)[0]
    return length


def serve(jobs: BinaryIO, replies: BinaryIO) -> None:
    """Do jobs until there is nobody who could send more."""
    while len(head := jobs.read(LENGTH_BYTES)) == LENGTH_BYTES:
        reply = do(jobs.read(length_of(head)))
        replies.write(pack(reply))
        replies.flush()


def do(job: bytes) -> Reply:
    """Do one job.

    Args:
        job: A pickled function and its arguments.

    Raises:
        MemoryError: The job wants more than there is. What it left behind is unknown: the process
            has to end.
    """
    function, arguments = pickle.loads(job)
    try:
        return Reply("done", function(*arguments))
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
