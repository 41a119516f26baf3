"""`pilothouse export`: a piece of what a service recorded, as files for others."""

import argparse
from pathlib import Path

from api.cli.commands.command import Command
from api.cli.commands.record_options import add_record, pieces_in
from api.terminal_text import complain, counted

DONE, UNUSABLE = 0, 2

_TEXT = """\
Export what a service recorded. The service may be running.

jsonl: a folder of plain files, such as for the report of a bug. `pilothouse
       replay` decides it again on any computer; `events.jsonl` is for people

exit code: 0 done; 2 nothing can be exported, or it cannot be written
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    add_record(parser)
    parser.add_argument("--to", required=True, choices=("jsonl",), help="format")
    parser.add_argument(
        "--out",
        metavar="FOLDER",
        type=Path,
        default=Path("pilothouse-export"),
        help="where it is written; default: %(default)s",
    )


def _run(options: argparse.Namespace) -> int:
    from domain.errors import PilothouseError
    from service.exported_record import write_piece
    from service.storage.errors import UnusableFolderError
    from service.storage.sqlite.connection import FAILURES

    if options.out.exists():
        complain(f"{options.out} exists already")
        return UNUSABLE
    steps = 0
    try:
        for piece in pieces_in(options):
            steps += write_piece(piece, options.out)
    except (PilothouseError, UnusableFolderError, *FAILURES) as error:
        complain(str(error))
        return UNUSABLE
    print(f"{options.out}: {counted(steps, 'step')}")
    return DONE


COMMAND = Command("export", "write what was recorded as files", _TEXT, _add_options, _run)
