"""What a device may tell of."""

import pytest

from domain.inputs import (
    CheckpointReport,
    ErrorReport,
    NodeAnswer,
    NodeReport,
    ReactionReport,
    Reading,
    Readings,
    SourceFault,
)
from domain.link.messages import Told
from domain.link.ownership import Ownership, with_ages, with_stamps
from domain.link.settings import Owned
from domain.reaction_terms import ReactionState
from domain.state_and_mode import PartName
from domain.timebase import seconds
from tests.support.linked_pair import DRIVE, GRIPPER

UNDERCARRIAGE = PartName("undercarriage")
OWN = Ownership(Owned((DRIVE,), ("load",), (UNDERCARRIAGE,)))


@pytest.mark.parametrize(
    "told",
    [
        NodeReport(DRIVE),
        NodeAnswer(1, DRIVE, True),
        CheckpointReport(DRIVE, "done"),
        ErrorReport(UNDERCARRIAGE, "JAMMED", active=True),
        ReactionReport(UNDERCARRIAGE, "COOL", ReactionState.ACTING),
        Readings((Reading("load", 1.0),), "can"),
        SourceFault("load", "can", "no bus"),
    ],
)
def test_it_may_tell_of_its_own_parts_and_signals(told: Told) -> None:
    assert OWN.admit(told) is told


@pytest.mark.parametrize(
    "told",
    [
        NodeReport(GRIPPER),
        NodeAnswer(1, GRIPPER, True),
        CheckpointReport(GRIPPER, "done"),
        ErrorReport(GRIPPER, "JAMMED", active=True),
        ReactionReport(GRIPPER, "COOL", ReactionState.ACTING),
        ErrorReport(None, "BATTERY_LOW", active=True),
        Readings((Reading("estop", False),), "can"),
        SourceFault("estop", "can", "no bus"),
    ],
)
def test_it_cannot_speak_for_another_one(told: Told) -> None:
    assert OWN.admit(told) is None


def test_of_readings_those_of_its_own_signals_pass() -> None:
    told = Readings((Reading("estop", False), Reading("load", 1.0)), "can")

    assert OWN.admit(told) == Readings((Reading("load", 1.0),), "can")


def test_a_reading_is_as_old_there_as_here_whatever_the_clocks_say() -> None:
    told = Readings((Reading("load", 1.0, seconds(100)), Reading("load", 2.0)), "can")
    sent = with_ages(told, seconds(103))

    assert sent.items[0].stamp == seconds(-3)  # type: ignore[union-attr]
    assert with_stamps(sent, seconds(7)) == Readings(
        (Reading("load", 1.0, seconds(4)), Reading("load", 2.0)), "can"
    )


def test_what_has_no_stamp_stays_as_it_is() -> None:
    told = NodeReport(DRIVE)

    assert with_ages(told, seconds(3)) is told
