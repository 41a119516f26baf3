from domain.reaction_terms import Action


def test_the_actions_are_in_the_order_of_strength() -> None:
    strengths = [action.strength for action in Action]

    assert strengths == sorted(strengths)
    assert [str(action) for action in Action if action.has_target] == ["mode", "state"]
    assert [str(action) for action in Action if action.has_budget] == ["mode", "state", "restart"]
    assert [str(action) for action in Action if action.holds] == ["hold", "stop"]
