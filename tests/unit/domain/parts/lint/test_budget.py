from domain.parts.lint.budget import Budget


def test_a_budget_is_spent_when_all_its_steps_were_taken() -> None:
    budget = Budget(2)

    budget.spend()
    assert not budget.is_spent
    budget.spend(3)
    assert budget.is_spent
