"""`pilothouse replay`: what a service recorded, decided once more, and compared."""

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING

from api.cli.commands.command import Command, add_format, port, say_json
from api.cli.commands.record_options import add_record, pieces_in
from api.client.outcomes import Json
from api.terminal_text import complain, counted, say

if TYPE_CHECKING:
    from service.recorded_pieces import Piece
    from service.replay import Replayed

SAME, DIFFERENT, UNUSABLE = 0, 1, 2

_TEXT = """\
Replay what a service recorded: give its inputs to a fresh core, and compare all
that follows with what followed then. The service may be running.

DIR is its folder of data (see `serve --data`), or what `pilothouse export`
wrote.

With --page, show it in the monitor page instead, at any speed: the page has
pause, speed and time. It listens on this machine only, and nothing of it
reaches a robot.

exit code: 0 everything follows again;
           1 something else does, and the first difference is named;
           2 nothing can be replayed; with --page: the port is not available
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    add_record(parser)
    add_format(parser, "json: one object per piece")
    parser.add_argument("--page", action="store_true", help="show it in the monitor page")
    parser.add_argument("--port", type=port, default=8000, help="of the page; default: %(default)s")
    parser.add_argument(
        "--speed", type=_speed, default=1.0, help="of the page, 0.1 to 100; default: %(default)s"
    )


def _speed(text: str) -> float:
    speed = float(text)
    if not 0.1 <= speed <= 100:
        raise argparse.ArgumentTypeError(f"invalid speed {text}; expected 0.1 to 100")
    return speed


def _run(options: argparse.Namespace) -> int:
    from domain.errors import PilothouseError
    from service.storage.errors import UnusableFolderError
    from service.storage.sqlite.connection import FAILURES

    try:
        return _show(options) if options.page else replay(pieces_in(options), options.format)
    except (PilothouseError, UnusableFolderError, *FAILURES) as error:
        complain(str(error))
        return UNUSABLE


def _show(options: argparse.Namespace) -> int:
    from api.distribution import installed_version
    from api.replaying.recording import recording_of
    from api.replaying.replaying import serve_replay
    from api.serving.web_server import ListenError

    events = options.first_event, options.last_event
    recording = recording_of(options.folder, installed_version(), *events)
    try:
        serve_replay(recording, options.port, options.speed)
    except ListenError as error:
        complain(str(error))
        return UNUSABLE
    return SAME


def replay(pieces: Iterator["Piece"], how: str) -> int:
    """Replay one piece after the other, up to the first difference; return the exit code.

    Args:
        pieces: Of a record.
        how: `text` or `json`.

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
        if how == "json":
            say_json(_summary(piece, replayed))
        else:
            start = "the start of the run" if piece.state is None else f"step {piece.first}"
            say(f"run {piece.run}, from {start}: {_verdict(replayed)}")
        if replayed.difference is not None:
            return DIFFERENT
    return SAME


def _summary(piece: "Piece", replayed: "Replayed") -> Json:
    difference = replayed.difference
    return {
        "run": piece.run,
        "first_step": None if piece.state is None else piece.first,
        "steps": replayed.steps,
        "last_event": replayed.last_event,
        "difference": None if difference is None else difference.words,
    }


def _verdict(replayed: "Replayed") -> str:
    same = f"{counted(replayed.steps, 'step')} the same"
    if replayed.last_event is not None:
        same += f", up to event {replayed.last_event}"
    return same if replayed.difference is None else f"{same}; {replayed.difference.words}"


COMMAND = Command("replay", "decide once more what was recorded", _TEXT, _add_options, _run)
