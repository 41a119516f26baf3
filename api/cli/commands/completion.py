"""`pilothouse completion`: the script that lets a shell complete commands, options and names."""

import argparse
import sys

from api.cli.commands.command import Command
from api.client.outcomes import Outcome

_TEXT = """\
Print the script that lets a shell complete commands and options, and the names
of parts, modes, signals, errors and holds of the service that PILOTHOUSE_URL or
--url names. Without a service there are no names, and nothing is said.

  bash   eval "$(pilothouse completion bash)"      in ~/.bashrc
  zsh    eval "$(pilothouse completion zsh)"       in ~/.zshrc, after compinit
  fish   pilothouse completion fish | source       in ~/.config/fish/config.fish

exit code: 0 printed
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "shell", metavar="SHELL", choices=("bash", "zsh", "fish"), help="bash, zsh or fish"
    )


def _run(options: argparse.Namespace) -> int:
    from api.cli.completion import script_for

    sys.stdout.write(script_for(options.shell))
    return Outcome.SUCCEEDED


COMMAND = Command(
    "completion", "print the script for completion in a shell", _TEXT, _add_options, _run
)
