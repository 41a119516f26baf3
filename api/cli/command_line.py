"""The command `pilothouse`: which commands there are, and how one ends.

Modules are imported when a command needs them. So `--help` is quick, and `check_packages` can speak
before the import of a foreign package with the name of one of ours fails.
"""

import argparse
import os
import sys
from collections.abc import Sequence

from api.cli.commands import change, check, monitor, serve, simulate, task
from api.distribution import ForeignPackageError, check_packages, installed_version
from api.terminal_text import complain

FAILED, MISUSED, INTERRUPTED = 1, 2, 130

_COMMANDS = (
    serve.COMMAND,
    monitor.COMMAND,
    check.COMMAND,
    change.MODE,
    change.STATE,
    task.COMMAND,
    simulate.COMMAND,
)

_EXAMPLES = """\
examples:
  pilothouse serve                        the built-in robot, all simulated
  pilothouse monitor                      watch it, in this terminal
  pilothouse check robot.yaml             is this model right?
  pilothouse serve robot.yaml --port 9000 supervise it, with simulated nodes
  pilothouse mode actuation PERFORMANCE   change a mode, and follow the steps
  pilothouse state drive_base deactivate  take a part through a transition
  pilothouse task track.csv --preview     look at waypoints before the drive
  pilothouse task track.csv               drive them, and follow how far it is
  pilothouse simulate scenario.yaml       does it go as expected?
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code.

    Args:
        arguments: Those after the name of the command; None: those of the process.
    """
    parser = _parser()
    options = parser.parse_args(arguments)
    if options.run is None:
        parser.print_help()
        return MISUSED
    try:
        check_packages()
        code: int = options.run(options)
        sys.stdout.flush()
    except ForeignPackageError as error:
        complain(str(error))
        return FAILED
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        # Who read our output went away, as `head` does; the interpreter would complain at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="pilothouse",
        description="Supervise a robot: what it is in, what it should be in, and why.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"pilothouse {installed_version()}")
    parser.set_defaults(run=None)
    commands = parser.add_subparsers(metavar="COMMAND", title="commands")
    for command in _COMMANDS:
        added = commands.add_parser(
            command.name,
            help=command.about,
            description=command.text,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        added.set_defaults(run=command.run)
        command.add_options(added)
    return parser
