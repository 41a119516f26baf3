"""The options of commands that read what a service recorded."""

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from service.recorded_pieces import Piece


def add_record(parser: argparse.ArgumentParser) -> None:
    """Add the folder, and the options that choose a piece of it."""
    parser.add_argument("folder", metavar="DIR", type=Path, help="folder of data of one robot")
    parser.add_argument(
        "--from",
        dest="first_event",
        metavar="ID",
        type=int,
        help="first event that is wanted; the replay begins with the last checkpoint before it",
    )
    parser.add_argument(
        "--until", dest="last_event", metavar="ID", type=int, help="last event that is wanted"
    )


def pieces_in(options: argparse.Namespace) -> Iterator["Piece"]:
    """Yield the pieces that the options of `add_record` choose.

    Raises:
        PilothouseError: There is nothing that can be replayed, or it is broken.
        UnusableFolderError: The folder holds no log.
    """
    from api.distribution import installed_version
    from domain.errors import InvalidValueError
    from service.exported_record import is_export, read_pieces
    from service.recorded_pieces import pieces_of
    from service.storage.sqlite.recorded_log import RecordedLog

    if is_export(options.folder):
        if (options.first_event, options.last_event) != (None, None):
            raise InvalidValueError("what was exported is replayed as a whole")
        return read_pieces(options.folder)
    log = RecordedLog(options.folder)
    return pieces_of(log, installed_version(), options.first_event, options.last_event)
