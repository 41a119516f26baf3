import pytest
from pydantic import ValidationError

from api.http.schemas.reactions import ArmBody, ReactionJson
from domain.findings import Blocker
from domain.reaction_terms import Action, Arm, ReactionState, Until
from domain.reactions.reaction_view import ReactionView
from domain.timebase import seconds
from tests.support.manual_clock import ManualClock
from tests.support.models import ACTUATION, active


def test_a_reaction_is_shown_with_times_in_s_and_as_rfc_3339() -> None:
    view = ReactionView(
        "LIMP",
        ACTUATION,
        Arm.PASSIVE,
        ReactionState.PASSIVE,
        Action.MODE,
        active("SLOW"),
        seconds(2),
        (Blocker("CONDITION", "too hot", ("temperature",)),),
        2,
        "temperature > 50",
        seconds(0.5),
        Until.ACKNOWLEDGED,
        "an acknowledgement",
    )
    clock = ManualClock()
    shown = ReactionJson.of(view, clock)

    assert shown.target is not None
    assert (shown.target.mode, shown.for_s, shown.left) == ("SLOW", 0.5, 2)
    assert shown.since_at is not None
    assert shown.since_at.endswith("Z")
    assert [blocker.code for blocker in shown.blockers] == ["CONDITION"]


def test_arming_takes_one_of_three_words() -> None:
    assert ArmBody.model_validate({"arm": "disarmed"}).arm is Arm.DISARMED
    with pytest.raises(ValidationError):
        ArmBody.model_validate({"arm": "off"})
