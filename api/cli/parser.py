"""The parser of the command line; a command is loaded when it is the one that runs.

`stop` has to start quickly, and must not depend on what other commands import.
"""

import argparse
import importlib
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NoReturn

from api.cli.exit_codes import MISUSED, TABLE

if TYPE_CHECKING:
    from api.cli.commands.command import Command

GROUPS: Mapping[str, Mapping[str, str]] = {
    "run a robot": {
        "serve": "serve.COMMAND",
        "device": "device.COMMAND",
        "tracker": "tracker.COMMAND",
        "simulate": "simulate.COMMAND",
    },
    "act": {
        "stop": "stop.COMMAND",
        "release": "release.COMMAND",
        "hold": "hold.COMMAND",
        "mode": "change.MODE",
        "state": "change.STATE",
        "task": "task.COMMAND",
        "signal": "signal.COMMAND",
        "ack": "acknowledge.COMMAND",
        "shelve": "shelve.COMMAND",
    },
    "watch": {
        "monitor": "monitor.COMMAND",
        "why": "why.WHY",
        "errors": "errors.ERRORS",
        "reactions": "reactions.COMMAND",
        "devices": "devices.COMMAND",
        "events": "events.COMMAND",
    },
    "models": {"check": "check.COMMAND", "analyse": "analyse.COMMAND"},
    "recordings and measurements": {
        "replay": "replay.COMMAND",
        "export": "export.COMMAND",
        "profile": "profile.COMMAND",
    },
    "shell": {"completion": "completion.COMMAND"},
}
"""The commands as `--help` lists them; each with where it is found in `api.cli.commands`."""

_EXAMPLES = """\
examples:
  pilothouse serve                        run with the built-in simulated robot
  pilothouse serve robot.yaml --port 9000 supervise a model; nodes are simulated
  pilothouse monitor                      watch it in this terminal; q ends that
  pilothouse stop dog on the track        stop the vehicle, and tell why
  pilothouse mode actuation PERFORMANCE   change a mode, and follow the steps
  pilothouse task track.csv               submit a task, and follow its progress
  pilothouse why                          tell why the robot does not drive
  pilothouse events --follow              follow what happens, line by line
  pilothouse check robot.yaml             check a model file
"""
_ENVIRONMENT = """\
environment:
  PILOTHOUSE_URL         URL of the service; --url comes first
  PILOTHOUSE_TOKEN       token of the service
  PILOTHOUSE_TOKEN_FILE  file with the token
"""


class Parser(argparse.ArgumentParser):
    """A parser whose complaints name what may have been meant."""

    def error(self, message: str) -> NoReturn:
        """Complain, and end the process."""
        self.print_usage(sys.stderr)
        self.exit(MISUSED, f"{self.prog}: error: {message}{self._meant(message)}\n")

    def _meant(self, message: str) -> str:
        import difflib

        known = [*self._option_string_actions, *_choices_in(message)]
        given = re.search(r"invalid choice: '([^']*)'|unrecognized arguments: (\S+)", message)
        wrong = next((word for word in given.groups() if word), "") if given else ""
        near = difflib.get_close_matches(wrong, known, n=1)
        return f"; did you mean {near[0]}?" if near else ""


class _MainParser(Parser):
    """The parser of `pilothouse` itself, which lists its commands by what they are for."""

    def format_help(self) -> str:
        """Return the text of `pilothouse --help`."""
        listed = [f"{name}:\n{''.join(_lines(group))}" for name, group in GROUPS.items()]
        return "\n".join(
            [
                "usage: pilothouse COMMAND ...  (pilothouse COMMAND --help explains one)\n",
                f"{self.description}\n",
                *listed,
                "options:\n  -h, --help     show this help message and exit\n"
                "  --version      show the version and exit\n",
                _EXAMPLES,
                _ENVIRONMENT,
                TABLE,
            ]
        )


class _Version(argparse.Action):
    """Prints the version, which is looked up only then."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        """Print it, and end the process."""
        from api.distribution import installed_version

        print(f"pilothouse {installed_version()}")
        parser.exit()


def _lines(group: Mapping[str, str]) -> Iterator[str]:
    for name, place in group.items():
        yield f"    {name:<10}  {load(place).about}\n"


def _choices_in(message: str) -> list[str]:
    """Return the choices that a message of argparse lists."""
    _, _, listed = message.partition("(choose from ")
    return re.findall(r"[\w.-]+", listed)


def load(place: str) -> "Command":
    """Return a command by where it is found."""
    module, _, attribute = place.partition(".")
    command: Command = getattr(importlib.import_module(f"api.cli.commands.{module}"), attribute)
    return command


def places() -> dict[str, str]:
    """Return where each command is found, by its name."""
    return {name: place for group in GROUPS.values() for name, place in group.items()}


def parser_for(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """Return a parser with the command that the arguments name, or with all."""
    known = places()
    named = next((word for word in arguments if not word.startswith("-")), None)
    if named in known:
        known = {named: known[named]}
    return make_parser(known)


def make_parser(known: Mapping[str, str]) -> argparse.ArgumentParser:
    """Return a parser with some commands.

    Args:
        known: Where each is found, by its name.
    """
    parser = _MainParser(
        prog="pilothouse",
        description="Supervise a robot: its actual and target states and modes, with reasons.",
    )
    parser.add_argument("--version", action=_Version, nargs=0)
    parser.set_defaults(run=None, parser=parser, words=None)
    commands = parser.add_subparsers(metavar="COMMAND", parser_class=Parser)
    for name, place in known.items():
        command = load(place)
        added = commands.add_parser(
            name,
            help=command.about,
            description=command.text,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        added.set_defaults(
            run=command.run, parser=added, words=command.words, is_urgent=command.is_urgent
        )
        command.add_options(added)
    return parser
