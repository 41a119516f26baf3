"""The end of the service waits for the vehicle."""

import asyncio
from types import SimpleNamespace
from typing import cast

import pytest

from api.serving.standing import until_it_stands
from service.supervisor import Supervisor


class Watch:
    """A vehicle that is seen moving for so many looks."""

    def __init__(self, looks: float) -> None:
        self.left = looks

    @property
    def moves(self) -> bool:
        self.left -= 1
        return self.left >= 0


def supervisor_of(watch: Watch) -> Supervisor:
    driving = SimpleNamespace(watch=watch)
    return cast("Supervisor", SimpleNamespace(core=SimpleNamespace(driving=driving)))


async def test_it_is_waited_for_until_it_stands(monkeypatch: pytest.MonkeyPatch) -> None:
    slept: list[float] = []

    async def sleep(duration_s: float) -> None:
        slept.append(duration_s)

    monkeypatch.setattr(asyncio, "sleep", sleep)
    await until_it_stands(supervisor_of(Watch(3)))

    assert len(slept) == 3


async def test_one_that_never_stands_is_not_waited_for_without_end() -> None:
    watch = Watch(float("inf"))

    await until_it_stands(supervisor_of(watch), 0.0)

    assert watch.moves
