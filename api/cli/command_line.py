"""The command `pilothouse`: its subcommands and exit codes.

Modules are imported when a command needs them: `stop` and `--help` are therefore quick, and
`check_packages` can report a foreign package with the name of one of ours before its import fails.
"""

import errno
import io
import os
import sys
from collections.abc import Sequence

from api.cli.exit_codes import INTERRUPTED, MISUSED
from api.cli.parser import make_parser, parser_for, places
from api.cli.standard_files import give_up_output, open_missing
from api.client.outcomes import Outcome
from api.terminal_text import complain

# EPIPE: the reader of our output, such as `head`, has closed the pipe.
_OUTPUT_FAILED = frozenset({errno.EPIPE, errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EBADF})
_COMPLETION = "_ARGCOMPLETE"
"""Set by the shell while it asks what can follow on the command line."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code.

    Args:
        arguments: Command line arguments without the program name; None: those of the process.
    """
    open_missing()
    _show_all_characters()
    try:
        try:
            return _run(arguments)
        finally:
            # Also after `--help`, which ends with SystemExit.
            sys.stdout.flush()
    except KeyboardInterrupt:
        return INTERRUPTED
    except OSError as error:
        if error.filename is not None or error.errno not in _OUTPUT_FAILED:
            raise
        give_up_output()
        if not isinstance(error, BrokenPipeError):
            complain(f"cannot write to standard output: {error.strerror}")
        return Outcome.FAILED


def _run(arguments: Sequence[str] | None) -> int:
    given = sys.argv[1:] if arguments is None else arguments
    if _COMPLETION in os.environ:
        from api.cli.completion import complete

        complete(make_parser(places()))
    parser = parser_for(given)
    options, unknown = parser.parse_known_args(given)
    if options.words is not None:
        getattr(options, options.words).extend(unknown)
    elif unknown:
        options.parser.error(f"unrecognized arguments: {' '.join(unknown)}")
    if options.run is None:
        parser.print_help()
        return MISUSED
    if not (options.is_urgent or _is_whole()):
        return Outcome.FAILED
    code: int = options.run(options)
    return code


def _is_whole() -> bool:
    """Tell whether our packages are ours; complain if not."""
    from api.distribution import ForeignPackageError, check_packages

    try:
        check_packages()
    except ForeignPackageError as error:
        complain(str(error))
        return False
    return True


def _show_all_characters() -> None:
    """Show what the encoding of the terminal lacks as an escape, instead of failing."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
