from domain.reaction_terms import Action, Arm, ReactionState, Until
from domain.reactions.reaction_view import ReactionView
from domain.state_and_mode import PartName


def test_a_view_is_named_by_part_and_reaction() -> None:
    view = ReactionView(
        "HALT",
        PartName("left/arm"),
        Arm.ACTIVE,
        ReactionState.IDLE,
        Action.HOLD,
        None,
        None,
        (),
        None,
        "a",
        0,
        Until.CLEARED,
        "a",
    )

    assert view.name == "left/arm.HALT"
