"""`pilothouse device`: run the service of one device of a robot of several computers."""

import argparse
from dataclasses import replace
from pathlib import Path

from api.cli.commands.command import Command
from api.cli.commands.service_options import add_service_options, serve_options

_TEXT = """\
Run the service of one device of a robot of several computers, until Ctrl-C,
SIGTERM or SIGHUP; nodes keep their states.

NAME is one of the block `devices` of the robot file. Model and robot file must
mean the same on each computer of the robot. The device alone commands its
nodes, as the supervisor has it do, which is run by: pilothouse serve MODEL
--robot FILE. Cut off from it, it does what `offline` of the robot file says.

Its own page shows its part of the robot. What is asked there of its nodes is
refused; stop, hold and deactivate always pass.

By default devices and supervisor run on one machine. For several machines, see
`link` of the robot file: pip install 'pilothouse[link]' brings what it needs.

exit code: as of pilothouse serve
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("device", metavar="NAME", help="name of this device in the robot file")
    parser.add_argument("model", type=Path, metavar="MODEL", help="model file of the whole robot")
    parser.add_argument(
        "--robot",
        required=True,
        type=Path,
        metavar="FILE",
        help="robot file of the whole robot, with its devices",
    )
    add_service_options(
        parser, data="~/.local/state/pilothouse/ROBOT-NAME, where ROBOT is the name of the robot"
    )


def _run(options: argparse.Namespace) -> int:
    from api.serving.serving import serve

    return serve(replace(serve_options(options), device=options.device))


COMMAND = Command("device", "run one device of a robot", _TEXT, _add_options, _run)
