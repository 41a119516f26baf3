"""How often a process was started lately."""

from domain.processes.start_budget import StartBudget
from domain.timebase import seconds


def test_starts_are_used_up_and_come_back_one_after_the_other() -> None:
    budget = StartBudget(2, seconds(60))
    budget.note(seconds(5))
    budget.note(seconds(8))
    assert budget.left() == 0
    assert budget.wake_at() == seconds(65)

    budget.pass_time(seconds(65))

    assert (budget.left(), budget.wake_at()) == (1, seconds(68))


def test_to_refill_makes_all_starts_available() -> None:
    budget = StartBudget(2, seconds(60))
    budget.note(0)
    budget.refill()

    assert (budget.left(), budget.wake_at()) == (2, None)


def test_while_the_service_is_down_no_time_passes() -> None:
    budget = StartBudget(2, seconds(60))
    budget.note(seconds(5))
    later = StartBudget(2, seconds(60))

    later.restore(budget.ages(seconds(15)), seconds(1_000))

    assert (later.left(), later.wake_at()) == (1, seconds(1_050))


def test_what_is_too_old_is_not_restored() -> None:
    budget = StartBudget(2, seconds(60))
    budget.restore((seconds(61), seconds(60), seconds(59)), seconds(100))

    assert budget.left() == 1


def test_a_budget_that_became_smaller_is_used_up() -> None:
    budget = StartBudget(1, seconds(60))
    budget.restore((seconds(3), seconds(2), seconds(1)), seconds(100))

    assert budget.left() == 0
