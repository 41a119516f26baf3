import pytest

from service.sources.reopened import Reopened
from tests.support.sources import Device


class Opened(Device):
    """A device that is open."""


def test_a_device_is_opened_when_it_is_first_needed_and_kept_open() -> None:
    opened: list[Opened] = []

    def open_it() -> Opened:
        opened.append(Opened())
        return opened[-1]

    device = Reopened(open_it)
    assert opened == []
    assert [device.use(lambda found: found.ask(1)) for _ in range(2)] == [0, 0]
    assert len(opened) == 1

    opened[0].is_there = False
    with pytest.raises(OSError, match="Remote"):
        device.use(lambda found: found.ask(1))
    assert opened[0].closed == 1

    device.use(lambda found: found.ask(1))
    assert len(opened) == 2
    device.close()
    device.close()
    assert opened[1].closed == 1


def test_a_device_that_does_not_close_either_says_why_it_broke() -> None:
    class Broken(Opened):
        def close(self) -> None:
            raise OSError(9, "Bad file descriptor")

    broken = Broken()
    broken.is_there = False
    with pytest.raises(OSError, match="Remote"):
        Reopened(lambda: broken).use(lambda found: found.ask(1))
