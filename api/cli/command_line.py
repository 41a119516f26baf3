"""The command `pilothouse`: its subcommands and exit codes.

Modules are imported when a command needs them. `--help` is therefore quick, and `check_packages`
can report a foreign package with the name of one of ours before its import fails.
"""

import argparse
import difflib
import errno
import re
import sys
from collections.abc import Sequence
from typing import NoReturn

from api.cli.commands import (
    analyse,
    change,
    check,
    errors,
    export,
    monitor,
    profile,
    reactions,
    replay,
    serve,
    simulate,
    task,
    why,
)
from api.cli.standard_files import give_up_output, open_missing
from api.distribution import ForeignPackageError, check_packages, installed_version
from api.terminal_text import complain

FAILED, MISUSED, INTERRUPTED = 1, 2, 130

# EPIPE: the reader of our output, such as `head`, has closed the pipe.
_OUTPUT_FAILED = frozenset({errno.EPIPE, errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EBADF})

_COMMANDS = (
    serve.COMMAND,
    monitor.COMMAND,
    check.COMMAND,
    analyse.COMMAND,
    change.MODE,
    change.STATE,
    why.WHY,
    errors.ERRORS,
    reactions.COMMAND,
    task.COMMAND,
    simulate.COMMAND,
    profile.COMMAND,
    replay.COMMAND,
    export.COMMAND,
)

_EXAMPLES = """\
examples:
  pilothouse serve                        run with the built-in simulated robot
  pilothouse monitor                      watch it in this terminal
  pilothouse check robot.yaml             check a model file
  pilothouse analyse robot.yaml           find single points of failure
  pilothouse serve robot.yaml --port 9000 supervise it, with simulated nodes
  pilothouse errors                       list what is wrong, roots first
  pilothouse reactions                    list what it does about that
  pilothouse mode actuation PERFORMANCE   change a mode, and follow the steps
  pilothouse state drive_base deactivate  request a lifecycle transition
  pilothouse task track.csv --preview     preview the waypoints of a task
  pilothouse task track.csv               submit a task, and follow its progress
  pilothouse simulate scenario.yaml       run a scenario, and compare results
  pilothouse profile --plot               measure how fast the robot is stopped
  pilothouse replay DIR                   decide again what was recorded
  pilothouse export DIR --to jsonl        write it as files, for a bug report
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code.

    Args:
        arguments: Command line arguments without the program name; None: those of the process.
    """
    open_missing()
    try:
        try:
            return _run(arguments)
        finally:
            # Also after `--help`, which ends with SystemExit.
            sys.stdout.flush()
    except ForeignPackageError as error:
        complain(str(error))
        return FAILED
    except KeyboardInterrupt:
        return INTERRUPTED
    except OSError as error:
        if error.filename is not None or error.errno not in _OUTPUT_FAILED:
            raise
        give_up_output()
        if not isinstance(error, BrokenPipeError):
            complain(f"cannot write to standard output: {error.strerror}")
        return FAILED


def _run(arguments: Sequence[str] | None) -> int:
    parser = _parser()
    options, unknown = parser.parse_known_args(arguments)
    if unknown:
        options.parser.error(f"unrecognized arguments: {' '.join(unknown)}")
    if options.run is None:
        parser.print_help()
        return MISUSED
    check_packages()
    code: int = options.run(options)
    return code


class _Parser(argparse.ArgumentParser):
    """A parser whose complaints name what may have been meant."""

    def error(self, message: str) -> NoReturn:
        """Complain, and end the process."""
        known = [*self._option_string_actions, *_choices_in(message)]
        given = re.search(r"invalid choice: '([^']*)'|unrecognized arguments: (\S+)", message)
        wrong = next((word for word in given.groups() if word), "") if given else ""
        near = difflib.get_close_matches(wrong, known, n=1)
        super().error(f"{message}; did you mean {near[0]}?" if near else message)


def _choices_in(message: str) -> list[str]:
    """Return the choices that a message of argparse lists."""
    _, _, listed = message.partition("(choose from ")
    return re.findall(r"[\w.-]+", listed)


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="pilothouse",
        description="Supervise a robot: its actual and target states and modes, with reasons.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"pilothouse {installed_version()}")
    parser.set_defaults(run=None, parser=parser)
    commands = parser.add_subparsers(metavar="COMMAND", title="commands")
    for command in _COMMANDS:
        added = commands.add_parser(
            command.name,
            help=command.about,
            description=command.text,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        added.set_defaults(run=command.run, parser=added)
        command.add_options(added)
    return parser
