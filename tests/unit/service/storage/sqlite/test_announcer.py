import asyncio
import threading
from collections.abc import AsyncIterator

import pytest
from pydantic_core import from_json

from service.storage.sqlite.announced_file import ROOM_BYTES
from service.storage.sqlite.announcer import Announcer, record_of


class File:
    """Takes texts once the test lets it."""

    def __init__(self) -> None:
        self.gate = threading.Event()
        self.gate.set()
        self.error: OSError | None = None
        self.texts: list[bytes] = []

    def write(self, text: bytes) -> None:
        self.gate.wait(20.0)
        if self.error is not None:
            raise self.error
        self.texts.append(text)


@pytest.fixture
def file() -> File:
    return File()


@pytest.fixture
async def announcer(file: File) -> AsyncIterator[Announcer]:
    announcer = Announcer(file)  # type: ignore[arg-type]
    yield announcer
    file.gate.set()
    announcer.end()


async def test_all_who_come_while_the_disk_is_busy_share_one_write(
    file: File, announcer: Announcer
) -> None:
    file.gate.clear()
    first, *others = [asyncio.create_task(announcer.announce([n, "release"])) for n in range(32)]
    await asyncio.sleep(0)
    file.gate.set()
    await asyncio.gather(first, *others)

    assert [len(from_json(text)) for text in file.texts] == [1, 31]


async def test_a_disk_that_fails_is_told_to_all_who_share_a_write(
    file: File, announcer: Announcer
) -> None:
    file.error = OSError("broken")
    told = await asyncio.gather(*(announcer.announce(n) for n in range(3)), return_exceptions=True)
    assert [str(each) for each in told] == ["broken"] * 3

    file.error = None
    await announcer.announce("again")
    assert file.texts == [b'["again"]']


async def test_whoever_gave_up_holds_nobody_up(file: File, announcer: Announcer) -> None:
    file.gate.clear()
    impatient = asyncio.create_task(announcer.announce("impatient"))
    patient = asyncio.create_task(announcer.announce("patient"))
    await asyncio.sleep(0)
    impatient.cancel()
    await asyncio.sleep(0)
    file.gate.set()

    await patient
    assert impatient.cancelled()


def test_of_too_many_the_newest_are_written() -> None:
    record = record_of([[number, "ReleaseRequest"] for number in range(1_000)])

    kept = from_json(record)
    assert len(record) <= ROOM_BYTES
    assert len(kept) > 100
    assert kept[-1] == [999, "ReleaseRequest"]
    assert [number for number, _ in kept] == list(range(1_000 - len(kept), 1_000))
