"""`pilothouse replay`: what a service recorded, decided once more, and compared."""

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING

from api.cli.commands.command import Command
from api.cli.commands.record_options import add_record, pieces_in
from api.terminal_text import complain, counted

if TYPE_CHECKING:
    from service.recorded_pieces import Piece
    from service.replay import Replayed

SAME, DIFFERENT, UNUSABLE = 0, 1, 2

_TEXT = """\
Replay what a service recorded: give its inputs to a fresh core, and compare all
that follows with what followed then. The service may be running.

DIR is its folder of data (see `serve --data`), or what `pilothouse export`
wrote.

exit code: 0 everything follows again;
           1 something else does, and the first difference is named;
           2 nothing can be replayed
"""


def _run(options: argparse.Namespace) -> int:
    from domain.errors import PilothouseError
    from service.storage.errors import UnusableFolderError
    from service.storage.sqlite.connection import FAILURES

    try:
        return replay(pieces_in(options))
    except (PilothouseError, UnusableFolderError, *FAILURES) as error:
        complain(str(error))
        return UNUSABLE


def replay(pieces: Iterator["Piece"]) -> int:
    """Replay one piece after the other, up to the first difference; return the exit code.

    Args:
        pieces: Of a record.

    Raises:
        PilothouseError: A piece is broken, or its core cannot be made again.
    """
    from api.distribution import installed_version
    from service.replay import replay_piece

    version = installed_version()
    for piece in pieces:
        if piece.boot.version != version:
            complain(f"run {piece.run} was recorded by release {piece.boot.version}")
        replayed = replay_piece(piece, version)
        start = "the start of the run" if piece.state is None else f"step {piece.first}"
        print(f"run {piece.run}, from {start}: {_verdict(replayed)}")
        if replayed.difference is not None:
            return DIFFERENT
    return SAME


def _verdict(replayed: "Replayed") -> str:
    same = f"{counted(replayed.steps, 'step')} the same"
    if replayed.last_event is not None:
        same += f", up to event {replayed.last_event}"
    return same if replayed.difference is None else f"{same}; {replayed.difference.words}"


COMMAND = Command("replay", "decide once more what was recorded", _TEXT, add_record, _run)
