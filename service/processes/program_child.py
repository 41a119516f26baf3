"""Becomes the program of a node; run as a file, with the standard library alone.

First it tells the guard which processes are to end with the service: those of its own group.
Arguments: number of the pipe to the guard, working directory, then the command.
"""

import os
import signal
import sys

NOT_FOUND, NOT_RUN = 127, 126
"""Exit codes of a command that is not there, or cannot be run; those of POSIX shells."""


def main(guard: str, folder: str, *command: str) -> None:
    """Become the program; return only if that fails."""
    # Python ignores these, and a program would inherit that.
    for name in ("SIGPIPE", "SIGXFSZ"):
        signal.signal(getattr(signal, name), signal.SIG_DFL)
    pipe = int(guard)
    try:
        os.set_inheritable(pipe, False)
        os.write(pipe, f"+{os.getpid()}\n".encode())
        os.chdir(folder)
        os.execvp(command[0], command)
    except OSError as error:
        what = error.filename if error.filename == folder else command[0]
        print(f"pilothouse: cannot run {what}: {error.strerror}", file=sys.stderr, flush=True)
        os._exit(NOT_FOUND if isinstance(error, FileNotFoundError) else NOT_RUN)


if __name__ == "__main__":
    main(*sys.argv[1:])
