"""What is on disk before a request is carried out, and what its answer waits for."""

import asyncio

import pytest

from domain.errors import StorageDegradedError
from domain.inputs import (
    HoldRequest,
    Input,
    ReleaseRequest,
    StorageStatus,
)
from domain.outbox import NOTHING, Outputs
from domain.timebase import Instant, to_seconds
from service.keeper import (
    LOOK_EVERY,
    SAFER_S,
    WORKS_FOR,
    Checkpoint,
    Keeper,
    Memory,
)
from service.storage.journal import Plain
from tests.support.manual_clock import ManualClock
from tests.support.waiting import until

RELEASE = ReleaseRequest("operator")
HOLD = HoldRequest("operator", "lunch")


class Disk:
    """The part of a journal that a keeper uses; what is done is told in order."""

    is_durable = True

    def __init__(self) -> None:
        self.fault: str | None = None
        self.done: list[str] = []
        self.kept: dict[str, Plain] = {}
        self.given: list[Input] = []
        self.answers: list[bool | StorageDegradedError] = []

    def keep(self, name: str, value: Plain) -> None:
        self.kept[name] = value

    async def announce(self, what: Plain, patience_s: float) -> bool:
        return await self._wait(f"announce {what} in {patience_s:g} s")

    async def commit(self, patience_s: float) -> bool:
        return await self._wait(f"wait {patience_s:g} s for the disk")

    async def _wait(self, what: str) -> bool:
        self.done.append(what)
        answer = self.answers.pop(0) if self.answers else True
        if isinstance(answer, StorageDegradedError):
            raise answer
        return answer

    def submit(self, given: Input) -> Outputs:
        self.done.append(f"do {type(given).__name__}")
        self.given.append(given)
        return NOTHING


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
def disk() -> Disk:
    return Disk()


@pytest.fixture
def keeper(disk: Disk, clock: ManualClock) -> Keeper:
    return Keeper(disk, disk.submit, clock)  # type: ignore[arg-type]


async def test_a_release_is_on_disk_before_the_robot_may_drive(disk: Disk, keeper: Keeper) -> None:
    taken = await keeper.request(RELEASE, first=True)

    assert taken.is_durable
    assert disk.done == [
        "announce [1, 'ReleaseRequest'] in 2 s",
        "do ReleaseRequest",
        "wait 2 s for the disk",
    ]


async def test_what_only_memory_keeps_is_not_called_durable(disk: Disk, keeper: Keeper) -> None:
    disk.is_durable = False

    assert not (await keeper.request(RELEASE, first=True)).is_durable


async def test_a_hold_does_not_wait_for_the_disk(disk: Disk, keeper: Keeper) -> None:
    await keeper.request(HOLD, first=False)

    assert disk.done == ["do HoldRequest", f"wait {SAFER_S:g} s for the disk"]


async def test_a_hold_is_answered_though_the_disk_is_slow(disk: Disk, keeper: Keeper) -> None:
    disk.answers = [False]

    assert not (await keeper.request(HOLD, first=False)).is_durable


async def test_a_hold_is_set_though_the_disk_is_broken(disk: Disk, keeper: Keeper) -> None:
    disk.answers = [StorageDegradedError("it is full")]

    assert not (await keeper.request(HOLD, first=False)).is_durable
    assert "do HoldRequest" in disk.done


@pytest.mark.parametrize("answer", [False, StorageDegradedError("it is full")])
async def test_nothing_is_released_that_cannot_be_stored(
    disk: Disk, keeper: Keeper, answer: bool | StorageDegradedError
) -> None:
    disk.answers = [answer]

    with pytest.raises(StorageDegradedError):
        await keeper.request(RELEASE, first=True)
    assert "do ReleaseRequest" not in disk.done


async def test_a_person_may_release_though_the_disk_is_broken(disk: Disk, keeper: Keeper) -> None:
    disk.answers = [StorageDegradedError("it is full")]

    taken = await keeper.request(RELEASE, first=False)

    assert not taken.is_durable
    assert disk.done[0] == "do ReleaseRequest"


FULL = StorageStatus(available=False, reason="the disk is full")


async def test_a_disk_that_fails_is_told_to_the_core_once_and_its_recovery_too(
    disk: Disk, keeper: Keeper, clock: ManualClock
) -> None:
    keeper.look()
    disk.fault = "the disk is full"
    keeper.look()
    keeper.look()
    disk.fault = None
    await clock.advance(to_seconds(WORKS_FOR))
    keeper.look()
    keeper.look()

    assert disk.given == [FULL, StorageStatus(available=True)]


async def test_a_full_disk_that_takes_a_write_now_and_then_is_told_once(
    disk: Disk, keeper: Keeper, clock: ManualClock
) -> None:
    for _ in range(5):
        disk.fault = "the disk is full"
        keeper.look()
        disk.fault = None
        await clock.advance(to_seconds(WORKS_FOR) - 0.1)
        keeper.look()

    assert disk.given == [FULL]


async def test_a_memory_is_kept_when_it_changed_and_not_too_often(
    disk: Disk, clock: ManualClock
) -> None:
    pose = [0.0]
    memory = Memory("pose", lambda: list(pose), lambda: pose[0], 2 * LOOK_EVERY)
    keeper = Keeper(disk, disk.submit, clock, [memory])  # type: ignore[arg-type]
    keeper.look()
    assert disk.kept == {"pose": [0.0]}

    pose[0] = 1.0
    keeper.look()
    assert disk.kept == {"pose": [0.0]}

    await clock.advance(to_seconds(2 * LOOK_EVERY))
    keeper.look()
    assert disk.kept == {"pose": [1.0]}
    disk.done.clear()
    await clock.advance(to_seconds(2 * LOOK_EVERY))
    keeper.look()
    assert disk.done == []


async def test_it_looks_four_times_a_second(disk: Disk, clock: ManualClock, keeper: Keeper) -> None:
    looking = asyncio.create_task(keeper.run())
    await asyncio.sleep(0)
    disk.fault = "the disk is full"
    await clock.advance(0.25)
    looking.cancel()

    assert disk.given == [StorageStatus(available=False, reason="the disk is full")]


class WithCheckpoints(Disk):
    """A journal that wants a checkpoint."""

    wants_checkpoint = True
    last_step = 7

    def checkpoint(self, step: int, at: Instant, state: bytes) -> None:
        self.wants_checkpoint = False
        self.done.append(f"checkpoint after step {step}: {state.decode()}")


@pytest.mark.parametrize("is_large", [False, True])
async def test_a_checkpoint_is_of_the_moment_in_which_it_was_begun(
    clock: ManualClock, is_large: bool
) -> None:
    disk = WithCheckpoints()
    checkpoint = Checkpoint(lambda: b"state", is_large)
    keeper = Keeper(disk, disk.submit, clock, checkpoint=checkpoint)  # type: ignore[arg-type]
    keeping = asyncio.create_task(keeper.run())
    await asyncio.sleep(0)
    await clock.advance(0.25)
    await until(lambda: bool(disk.done))
    keeping.cancel()

    assert disk.done == ["checkpoint after step 7: state"]


def test_a_memory_that_is_kept_with_each_step_never_waits(disk: Disk, clock: ManualClock) -> None:
    state = ["active"]
    memory = Memory("nodes", lambda: list(state), lambda: state[0], 0)
    keeper = Keeper(disk, disk.submit, clock, [memory])  # type: ignore[arg-type]
    keeper.keep_with_step(clock.now())
    state[0] = "inactive"
    keeper.keep_with_step(clock.now())

    assert disk.kept == {"nodes": ["inactive"]}
    disk.done.clear()
    keeper.keep_with_step(clock.now())
    assert disk.done == []


def test_what_takes_long_to_gather_is_not_kept_with_a_step(disk: Disk, clock: ManualClock) -> None:
    memory = Memory("nodes", lambda: ["active"], lambda: 1, LOOK_EVERY)
    keeper = Keeper(disk, disk.submit, clock, [memory])  # type: ignore[arg-type]

    keeper.keep_with_step(clock.now())
    assert disk.kept == {}
    keeper.look()
    assert disk.kept == {"nodes": ["active"]}
