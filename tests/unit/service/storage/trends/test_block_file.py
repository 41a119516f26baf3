"""The file of blocks, and what is deleted from it."""

from dataclasses import replace
from pathlib import Path

import apsw
import pytest

from domain.timebase import seconds
from service.storage.trends.block_file import (
    MEMORY,
    Block,
    BlockFile,
    ForeignVersionError,
    set_aside,
)
from tests.support.trend_readings import SMALL_TIERS

BLOCK = Block(1, 100, 200, 3, "", b"123")


def test_blocks_are_found_by_signal_and_time() -> None:
    file = BlockFile(MEMORY, SMALL_TIERS)
    later = replace(BLOCK, from_at=300, to_at=400)
    file.write(0, [BLOCK, later, replace(BLOCK, signal=2)], 0)

    assert [*file.read(0, 1, 0, 1_000)] == [BLOCK, later]
    assert [*file.read(0, 1, 200, 299)] == [BLOCK]
    assert [*file.read(1, 1, 0, 1_000)] == []
    assert (file.oldest(0, 1), file.oldest(0, 3)) == (100, None)


def test_a_coarser_block_takes_what_is_there_of_the_finer_tier() -> None:
    file = BlockFile(MEMORY, SMALL_TIERS)
    file.write(0, [BLOCK], 0)
    file.write(1, [BLOCK], 0)
    later = replace(BLOCK, from_at=300)
    file.write(0, [later], 0)

    assert [*file.not_in_next(0)] == [later]


def test_blocks_that_were_kept_long_enough_go_first_come_first_gone() -> None:
    tiers = (replace(SMALL_TIERS[0], keep_for=seconds(60.0)), SMALL_TIERS[1])
    file = BlockFile(MEMORY, tiers)

    for minute in range(4):
        file.write(0, [replace(BLOCK, from_at=minute)], seconds(60.0 * minute))
        file.write(1, [replace(BLOCK, from_at=minute)], seconds(60.0 * minute))

    assert [block.from_at for block in file.read(0, 1, 0, 1_000)] == [2, 3]
    assert len([*file.read(1, 1, 0, 1_000)]) == 4
    assert file.ran() == seconds(180.0)


def test_beyond_its_size_a_tier_loses_its_oldest_blocks() -> None:
    tiers = (replace(SMALL_TIERS[0], keep_bytes=1_000), SMALL_TIERS[1])
    file = BlockFile(MEMORY, tiers)

    for number in range(30):
        file.write(0, [replace(BLOCK, from_at=number)], number)

    assert file.size <= 1_000
    assert [block.from_at for block in file.read(0, 1, 0, 1_000)][-1] == 29


def test_numbers_of_blocks_are_not_used_again_once_all_are_gone() -> None:
    tiers = (replace(SMALL_TIERS[0], keep_for=0), SMALL_TIERS[1])
    file = BlockFile(MEMORY, tiers)
    file.write(0, [BLOCK], 1)
    file.write(1, [BLOCK], 1)
    file.write(0, [], 2)
    file.write(0, [BLOCK], 2)

    assert [*file.not_in_next(0)] == [BLOCK]


def test_all_is_there_when_it_is_opened_again(tmp_path: Path) -> None:
    path = str(tmp_path / "trends.db")
    file = BlockFile(path, SMALL_TIERS)
    numbers = file.numbers(["load", "speed"])
    file.write(0, [BLOCK], 77)
    size = file.size
    file.close()
    assert Path(path).stat().st_mode & 0o777 == 0o600

    again = BlockFile(path, SMALL_TIERS)

    assert again.numbers(["speed", "mood"]).items() >= numbers.items()
    assert (again.ran(), again.size) == (77, size)
    assert [*again.read(0, 1, 0, 1_000)] == [BLOCK]
    again.close()


def test_a_file_of_a_newer_version_is_not_touched(tmp_path: Path) -> None:
    path = str(tmp_path / "trends.db")
    with apsw.Connection(path) as newer:
        newer.execute("PRAGMA user_version = 999")

    with pytest.raises(ForeignVersionError, match="version 999"):
        BlockFile(path, SMALL_TIERS)

    assert [entry.name for entry in tmp_path.iterdir()] == ["trends.db"]


def test_a_file_that_is_put_aside_never_replaces_another_one(tmp_path: Path) -> None:
    path = tmp_path / "trends.db"
    for content in ("first", "second"):
        path.write_text(content)
        set_aside(str(path))

    kept = sorted(tmp_path.iterdir())
    assert [entry.read_text() for entry in kept] == ["first", "second"]
    assert all(entry.name.startswith("trends.db.broken-") for entry in kept)
