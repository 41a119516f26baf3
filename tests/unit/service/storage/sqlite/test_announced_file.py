import errno
import os
from pathlib import Path

import pytest

from service.storage.sqlite import announced_file
from service.storage.sqlite.announced_file import AnnouncedFile, last_text


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "announced"


def opened(path: Path) -> AnnouncedFile:
    file = AnnouncedFile(path)
    file.renew()
    return file


def test_nothing_was_announced_before_the_first_time(path: Path) -> None:
    assert last_text(path) is None
    opened(path).close()
    assert last_text(path) is None


def test_what_was_announced_last_is_found_over_restarts(path: Path) -> None:
    for run in range(3):
        file = opened(path)
        for number in range(3):
            file.write(b"%d.%d" % (run, number))
            assert last_text(path) == b"%d.%d" % (run, number)
        file.close()


def test_the_file_takes_its_space_at_once(path: Path) -> None:
    file = opened(path)
    size = path.stat().st_size
    for number in range(10):
        file.write(b"x" * 100 * number)

    assert path.stat().st_size == size
    assert path.stat().st_mode & 0o777 == 0o600
    file.close()


def test_a_record_that_is_torn_anywhere_leaves_it_or_the_one_before(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    texts = [b"release of the hold", b"start of the task"]
    file = opened(path)
    file.write(b"an older one")
    file.write(texts[0])
    writes: list[tuple[bytes, int]] = []
    monkeypatch.setattr(
        announced_file, "write_synced", lambda _, content, offset: writes.append((content, offset))
    )
    file.write(texts[1])
    file.close()
    ((content, offset),) = writes
    before = path.read_bytes()

    for torn in range(len(content) + 1):
        after = bytearray(before)
        after[offset : offset + torn] = content[:torn]
        path.write_bytes(after)
        assert last_text(path) == texts[torn == len(content)]


def test_whatever_the_file_holds_it_can_be_read_and_used(path: Path) -> None:
    for content in (b"", b"x", b"\xff" * 8_192, bytes(8_192), b"\x01" * 5_000):
        path.write_bytes(content)
        assert last_text(path) is None
        file = opened(path)
        file.write(b"again")
        assert last_text(path) == b"again"
        file.close()


def test_nothing_is_announced_in_a_file_that_was_deleted(path: Path) -> None:
    file = opened(path)
    path.unlink()
    with pytest.raises(FileNotFoundError):
        file.write(b"release")

    file.renew()
    file.write(b"release")

    assert last_text(path) == b"release"
    file.close()


def test_nothing_is_announced_where_its_outcome_would_not_fit(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = opened(path)
    full = os.statvfs_result((4_096, 4_096, 10, 10, 10, 0, 0, 0, 0, 255))
    monkeypatch.setattr(os, "fstatvfs", lambda _: full)

    with pytest.raises(OSError, match="space") as failed:
        file.write(b"release")

    assert failed.value.errno == errno.ENOSPC
    file.close()


def test_a_disk_that_does_not_say_its_size_has_room(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    unknown = os.statvfs_result((4_096, 4_096, 0, 0, 0, 0, 0, 0, 0, 255))
    monkeypatch.setattr(os, "fstatvfs", lambda _: unknown)

    file = opened(path)
    file.write(b"release")

    assert last_text(path) == b"release"
    file.close()


def test_a_write_that_is_short_fails(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = opened(path)
    monkeypatch.setattr(os, "pwrite", lambda _, content, __: len(content) - 1)

    with pytest.raises(OSError, match="space"):
        file.write(b"release")
    file.close()


def test_nothing_is_announced_after_the_end(path: Path) -> None:
    file = opened(path)
    file.close()
    file.close()

    with pytest.raises(BrokenPipeError):
        file.write(b"release")
