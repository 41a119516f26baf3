"""Which piece of a record the options choose."""

import argparse
from pathlib import Path

import pytest

from api.cli.commands.record_options import add_record, pieces_in
from domain.errors import InvalidValueError
from service.exported_record import write_piece
from service.recorded_pieces import Piece
from service.storage.errors import UnusableFolderError
from service.storage.journal import Boot
from tests.support.manual_clock import START


def options(*arguments: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    add_record(parser)
    return parser.parse_args(arguments)


def test_without_options_the_whole_record_is_wanted() -> None:
    chosen = options("folder")

    assert (chosen.folder, chosen.first_event, chosen.last_event) == (Path("folder"), None, None)


def test_a_range_is_given_by_the_ids_of_events() -> None:
    chosen = options("folder", "--from", "17", "--until", "23")

    assert (chosen.first_event, chosen.last_event) == (17, 23)


def test_a_folder_without_a_log_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UnusableFolderError, match="holds no log"):
        list(pieces_in(options(str(tmp_path))))


def test_what_was_exported_is_replayed_as_a_whole(tmp_path: Path) -> None:
    boot = Boot("first", "1", 0, START, "", "")
    write_piece(Piece(1, boot, None, 1, iter(())), tmp_path)

    assert [piece.run for piece in pieces_in(options(str(tmp_path)))] == [1]
    with pytest.raises(InvalidValueError, match="as a whole"):
        pieces_in(options(str(tmp_path), "--from", "17"))
