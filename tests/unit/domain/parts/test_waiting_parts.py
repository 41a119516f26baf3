"""After a restart, nothing is activated by itself until an operator asks for something."""

import pytest

from domain.inputs import Restored
from domain.kept import KeptTarget
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.parts.system_model import SmhModel
from domain.parts.waiting_parts import WaitingParts
from domain.state_and_mode import PartName
from tests.support.models import ACTUATION, ARM, BASE, inactive, nested_model

MODEL = nested_model()
ROBOT, LIDAR = PartName("robot"), PartName("lidar")


def waiting(parts: WaitingParts, model: SmhModel = MODEL) -> set[PartName]:
    return {part for part in model.parts if parts.includes(part)}


def test_nothing_waits_before_a_restart() -> None:
    parts = WaitingParts(MODEL)
    parts.end(BASE)
    assert waiting(parts) == set()


def test_everything_waits_after_a_restart() -> None:
    parts = WaitingParts(MODEL)
    parts.begin()
    assert waiting(parts) == set(MODEL.parts)


@pytest.mark.parametrize(
    ("requested", "left"),
    [
        (BASE, {ROBOT, ACTUATION, ARM, LIDAR}),
        (ACTUATION, {ROBOT, LIDAR}),
        (ROBOT, set()),
    ],
)
def test_a_request_ends_the_wait_of_a_part_and_of_those_below_it(
    requested: PartName, left: set[PartName]
) -> None:
    parts = WaitingParts(MODEL)
    parts.begin()
    parts.end(requested)
    assert waiting(parts) == left


@pytest.mark.parametrize(
    ("restored", "waits"),
    [
        (Restored(), False),
        (Restored(boot=2), True),
        (Restored(kept=(KeptTarget(BASE, inactive(), 1),)), True),
        (Restored(stop_because="the stored state cannot be read"), True),
    ],
    ids=["first run", "second run", "something kept", "something lost"],
)
def test_only_the_first_run_of_a_robot_is_no_restart(restored: Restored, waits: bool) -> None:
    parts = Parts(MODEL, Outbox())
    parts.take_restored(restored, 0)
    assert parts.waits_for_operator(BASE) is waits
