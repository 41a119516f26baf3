"""`pilothouse export`: a piece of what a service recorded, as files for others."""

import argparse
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from api.cli.commands.command import Command, add_format, say_json
from api.cli.commands.record_options import add_record, pieces_in
from api.terminal_text import complain, counted, say

if TYPE_CHECKING:
    from service.recorded_pieces import Piece

DONE, UNUSABLE, INTERRUPTED = 0, 2, 130
_DEFAULT_OUT = {"jsonl": Path("pilothouse-export"), "mcap": Path("pilothouse-export.mcap")}
_PROGRESS_EVERY_S = 5.0

_TEXT = """\
Export what a service recorded. The service may be running.

jsonl: a folder of plain files, such as for the report of a bug. `pilothouse
       replay` decides it again on any computer; `events.jsonl` is for people
mcap:  a file for Foxglove or Lichtblick: system state, parts, signals, task,
       vehicle, pose, path, events. Needs: pip install 'pilothouse[recording]'

exit code: 0 done; 2 nothing can be exported, or it cannot be written;
           130 ended by Ctrl-C; then there is no file of mcap
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    add_record(parser)
    parser.add_argument("--to", required=True, choices=tuple(_DEFAULT_OUT), help="format")
    parser.add_argument(
        "--out",
        metavar="PATH",
        type=Path,
        help="folder or file that is written; default: pilothouse-export, for mcap"
        " pilothouse-export.mcap",
    )
    add_format(parser, "json: {path, steps} or {path, messages}")


def _run(options: argparse.Namespace) -> int:
    from api.recording.mcap_file import NoMcapError
    from domain.errors import PilothouseError
    from service.storage.errors import UnusableFolderError
    from service.storage.sqlite.connection import FAILURES

    out = options.out or _DEFAULT_OUT[options.to]
    if out.exists():
        complain(f"{out} exists already")
        return UNUSABLE
    try:
        write = _write_mcap if options.to == "mcap" else _write_jsonl
        count, what = write(pieces_in(options), out, options)
        if options.format == "json":
            say_json({"path": str(out), f"{what}s": count})
        else:
            say(f"{out}: {counted(count, what)}")
    except (NoMcapError, PilothouseError, UnusableFolderError, *FAILURES) as error:
        complain(str(error))
        return UNUSABLE
    except KeyboardInterrupt:
        return INTERRUPTED
    return DONE


def _write_jsonl(pieces: Iterator["Piece"], out: Path, _: argparse.Namespace) -> tuple[int, str]:
    """Write the files; return how many of what are in them."""
    from service.exported_record import write_piece

    return sum(write_piece(piece, out) for piece in pieces), "step"


def _write_mcap(
    pieces: Iterator["Piece"], out: Path, options: argparse.Namespace
) -> tuple[int, str]:
    """Write the file; return how many of what are in it."""
    from api.distribution import installed_version
    from api.recording.mcap_export import export_mcap
    from api.recording.mcap_file import require_mcap

    require_mcap()
    tell = _progress(time.monotonic)
    count = export_mcap(pieces, installed_version(), out, options.first_event, tell)
    return count, "message"


def _progress(clock: Callable[[], float]) -> Callable[[int, int], None]:
    """Return what tells every few seconds how far an export is; `clock` returns seconds."""
    from service.clock import to_datetime

    told_at = clock()

    def tell(at_ns: int, messages: int) -> None:
        nonlocal told_at
        if clock() - told_at >= _PROGRESS_EVERY_S:
            told_at = clock()
            moment = to_datetime(at_ns).strftime("%Y-%m-%d %H:%M:%S")
            complain(f"at {moment} UTC: {counted(messages, 'message')}")

    return tell


COMMAND = Command("export", "write what was recorded as files", _TEXT, _add_options, _run)
