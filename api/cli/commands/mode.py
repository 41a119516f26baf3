"""`pilothouse mode`: change the mode of a system or node."""

import argparse

from api.cli.commands.command import CHANGE_CODES, Command, add_change_options, ask_for_change

_ABOUT = "change the mode of a system or node"


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("part", metavar="PART", help="name of a system or node")
    parser.add_argument("mode", metavar="MODE", help="name of one of its modes")
    add_change_options(parser)


def _run(options: argparse.Namespace) -> int:
    return ask_for_change(options, "mode", {"mode": options.mode})


COMMAND = Command("mode", _ABOUT, f"{_ABOUT.capitalize()}.\n\n{CHANGE_CODES}", _add_options, _run)
