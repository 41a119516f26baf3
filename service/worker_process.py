"""The process of `service.worker`: runs jobs from its standard input, one after the other.

Messages are pickles. Only `service.worker` sends them, with functions of this program and their
arguments.
"""

import errno
import importlib
import os
import pickle
import signal
import struct
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO, Literal, NamedTuple

from domain.errors import PilothouseError

MEMORY_LIMIT_BYTES = 2 * 1024**3
"""Address space that jobs may take beyond what the interpreter and its libraries have. A job beyond
it gets a MemoryError; other processes are safe."""
OUT_OF_MEMORY = 77
"""Exit code of a process that needed more memory than it may have."""

_KILL_AT_PARENTS_DEATH = 1
"""PR_SET_PDEATHSIG of prctl(2)."""

_NICENESS = 5
_LENGTH = struct.Struct("!Q")
LENGTH_BYTES = _LENGTH.size


class Reply(NamedTuple):
    """The result of a job."""

    outcome: Literal["done", "refused", "failed"]
    value: object
    """done: the return value; refused: the `PilothouseError`; failed: the traceback as text."""


class ErrorParcel(NamedTuple):
    """A pickled PilothouseError, field by field: its constructor takes other arguments."""

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
    """Wrap bytes so that they are sent next to the pickle instead of being copied into it."""
    return pickle.PickleBuffer(value) if isinstance(value, bytes) else value


def pack(message: object) -> list[bytes | memoryview]:
    """Return a message in the pieces that are sent; large values are not copied.

    The first piece holds the number and the lengths of the others. They are a pickle and the large
    values next to it, such as a body or the numbers of a path.
    """
    beside: list[pickle.PickleBuffer] = []
    data = pickle.dumps(message, protocol=5, buffer_callback=beside.append)
    pieces: list[bytes | memoryview] = [data, *(buffer.raw() for buffer in beside)]
    lengths = b"".join(number_of(len(piece)) for piece in pieces)
    return [number_of(len(pieces)) + lengths, *pieces]


def unpack(pieces: Sequence[bytes]) -> object:
    """Return the message that the pieces hold."""
    message: object = pickle.loads(pieces[0], buffers=pieces[1:])
    return message


def number_of(value: int) -> bytes:
    """Encode a number or length."""
    return _LENGTH.pack(value)


def numbers_in(head: bytes) -> tuple[int, ...]:
    """Decode numbers or lengths."""
    return tuple(number for (number,) in _LENGTH.iter_unpack(head))


def read(stream: BinaryIO) -> object | None:
    """Return the next message; None: the stream ended, maybe within a message."""
    head = stream.read(LENGTH_BYTES)
    if len(head) < LENGTH_BYTES:
        return None
    (count,) = numbers_in(head)
    lengths = numbers_in(stream.read(count * LENGTH_BYTES))
    return unpack([stream.read(length) for length in lengths])


def serve(jobs: BinaryIO, replies: BinaryIO) -> None:
    """Run jobs until the standard input ends."""
    while (job := read(jobs)) is not None:
        for piece in pack(do(job)):
            replies.write(piece)
        replies.flush()


def do(job: Any) -> Reply:  # noqa: ANN401  # whatever `service.worker` sent
    """Run one job.

    Args:
        job: A function and its arguments.

    Raises:
        MemoryError: The job needs more memory than allowed. The process must end, since its state
            is unknown.
        ImportError: The same, of a library that the job was the first to use.
    """
    function, arguments = job
    try:
        return Reply("done", large(function(*arguments)))
    except PilothouseError as error:
        return Reply("refused", ErrorParcel.of(error))
    except MemoryError:
        raise
    except Exception as error:
        if isinstance(error, ImportError) and _is_short_of_memory(error):
            raise
        # The edge of this process: the caller gets the traceback of a bug in its job.
        return Reply("failed", traceback.format_exc())


def memory_limit(used: int, soft: int, hard: int, infinity: int) -> int:
    """Return the limit of the address space for a process, in bytes.

    Args:
        used: What it has already.
        soft: The limit that it was given, as by `ulimit -v`; `infinity`: none.
        hard: The most that it may set.
        infinity: Stands for no limit.
    """
    given = [limit for limit in (soft, hard) if limit != infinity]
    return min([used + MEMORY_LIMIT_BYTES, *given])


def _limit_memory() -> None:
    import resource

    # The first number is the size of the address space in pages; there is none on macOS.
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except OSError:
        pages = 0
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    used = pages * resource.getpagesize()
    limit = memory_limit(used, soft, hard, resource.RLIM_INFINITY)
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))


def _end_with(parent: int) -> None:
    """Let the kernel kill this process when its parent ends, also during a job.

    Without Linux, it ends when it reads the next job.
    """
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(_KILL_AT_PARENTS_DEATH, int(signal.SIGKILL))
        if os.getppid() != parent:
            sys.exit("the service has ended already")


def _is_short_of_memory(error: BaseException) -> bool:
    """Tell whether an error means that memory is short; the loader of libraries has only words."""
    if isinstance(error, OSError) and error.errno == errno.ENOMEM:
        return True
    words = str(error).lower()
    return isinstance(error, MemoryError) or "map segment" in words or "allocate" in words


def main() -> None:
    """Lower the own priority, import the modules named in the arguments, then run jobs.

    The first argument is the process that started this one.
    """
    _end_with(int(sys.argv[1]))
    os.nice(_NICENESS)
    replies = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    # Output of a job must not mix with the replies.
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    try:
        for module in sys.argv[2:]:
            importlib.import_module(module)
        if sys.platform != "win32":
            _limit_memory()
        serve(sys.stdin.buffer, replies)
    except (MemoryError, ImportError, OSError) as error:
        if not _is_short_of_memory(error):
            raise
        # The service logs it.
        os._exit(OUT_OF_MEMORY)
