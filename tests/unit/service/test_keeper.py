"""What is on disk before a request is carried out, and what its answer waits for."""

import pytest

from domain.errors import StorageDegradedError
from domain.health.signals import ESTOP
from domain.identifiers import ChangeId
from domain.inputs import (
    AcknowledgeRequest,
    CancelRequest,
    CancelTaskRequest,
    EmergencyStopRequest,
    HoldRequest,
    Input,
    ModeRequest,
    ParametersRequest,
    ReleaseRequest,
    TimePassed,
    TransitionRequest,
)
from domain.lifecycle import Transition
from domain.outbox import NOTHING, Outputs
from service.keeper import SAFER_S, Keeper, starts_or_loosens
from service.storage.journal import Plain
from tests.support.models import BASE

RELEASE = ReleaseRequest("operator")
HOLD = HoldRequest("operator", "lunch")


class Disk:
    """The part of a journal that a keeper uses; what is done is told in order."""

    def __init__(self) -> None:
        self.done: list[str] = []
        self.answers: list[bool | StorageDegradedError] = []

    def keep(self, name: str, value: Plain) -> None:
        self.done.append("store the request")

    async def commit(self, patience_s: float) -> bool:
        self.done.append(f"wait {patience_s:g} s for the disk")
        answer = self.answers.pop(0) if self.answers else True
        if isinstance(answer, StorageDegradedError):
            raise answer
        return answer

    def submit(self, given: Input) -> Outputs:
        self.done.append(f"do {type(given).__name__}")
        return NOTHING


@pytest.fixture
def disk() -> Disk:
    return Disk()


@pytest.fixture
def keeper(disk: Disk) -> Keeper:
    return Keeper(disk, disk.submit)  # type: ignore[arg-type]


async def test_a_release_is_on_disk_before_the_robot_may_drive(disk: Disk, keeper: Keeper) -> None:
    taken = await keeper.request(RELEASE)

    assert taken.is_durable
    assert disk.done == [
        "store the request",
        "wait 2 s for the disk",
        "do ReleaseRequest",
        "wait 2 s for the disk",
    ]


async def test_a_hold_does_not_wait_for_the_disk(disk: Disk, keeper: Keeper) -> None:
    await keeper.request(HOLD)

    assert disk.done == ["do HoldRequest", f"wait {SAFER_S:g} s for the disk"]


async def test_a_hold_is_answered_though_the_disk_is_slow(disk: Disk, keeper: Keeper) -> None:
    disk.answers = [False]

    assert not (await keeper.request(HOLD)).is_durable


async def test_a_hold_is_set_though_the_disk_is_broken(disk: Disk, keeper: Keeper) -> None:
    disk.answers = [StorageDegradedError("it is full")]

    assert not (await keeper.request(HOLD)).is_durable
    assert "do HoldRequest" in disk.done


@pytest.mark.parametrize("answer", [False, StorageDegradedError("it is full")])
async def test_nothing_is_released_that_cannot_be_stored(
    disk: Disk, keeper: Keeper, answer: bool | StorageDegradedError
) -> None:
    disk.answers = [answer]

    with pytest.raises(StorageDegradedError):
        await keeper.request(RELEASE)
    assert "do ReleaseRequest" not in disk.done


async def test_a_person_may_release_though_the_disk_is_broken(disk: Disk, keeper: Keeper) -> None:
    disk.answers = [StorageDegradedError("it is full")]

    taken = await keeper.request(RELEASE, volatile=True)

    assert not taken.is_durable
    assert disk.done[0] == "do ReleaseRequest"


@pytest.mark.parametrize(
    "given",
    [
        ModeRequest(BASE, "FAST"),
        ParametersRequest(BASE, {"max_speed": 0.1}),
        TransitionRequest(BASE, Transition.CONFIGURE),
        TransitionRequest(BASE, Transition.ACTIVATE),
        RELEASE,
        AcknowledgeRequest(ESTOP),
        EmergencyStopRequest(engaged=False, reason=""),
    ],
)
def test_what_starts_or_loosens_is_stored_first(given: Input) -> None:
    assert starts_or_loosens(given)


@pytest.mark.parametrize(
    "given",
    [
        TransitionRequest(BASE, Transition.DEACTIVATE),
        TransitionRequest(BASE, Transition.CLEANUP),
        TransitionRequest(BASE, Transition.SHUTDOWN),
        HOLD,
        CancelTaskRequest(),
        CancelRequest(ChangeId("c1")),
        EmergencyStopRequest(engaged=True, reason="smoke"),
    ],
)
def test_what_makes_safer_is_done_first(given: Input) -> None:
    assert not starts_or_loosens(given)


def test_what_is_no_request_is_neither() -> None:
    with pytest.raises(TypeError, match="TimePassed"):
        starts_or_loosens(TimePassed())
