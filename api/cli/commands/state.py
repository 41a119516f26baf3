"""`pilothouse state`: take a system or node through a lifecycle transition."""

import argparse

from api.cli.commands.command import CHANGE_CODES, Command, add_change_options, ask_for_change

_TRANSITIONS = ("configure", "activate", "deactivate", "cleanup", "shutdown")

_ABOUT = "take a system or node through a lifecycle transition"


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("part", metavar="PART", help="name of a system or node")
    parser.add_argument(
        "transition", metavar="TRANSITION", choices=_TRANSITIONS, help=", ".join(_TRANSITIONS)
    )
    add_change_options(parser)


def _run(options: argparse.Namespace) -> int:
    return ask_for_change(options, "state", {"transition": options.transition})


COMMAND = Command("state", _ABOUT, f"{_ABOUT.capitalize()}.\n\n{CHANGE_CODES}", _add_options, _run)
