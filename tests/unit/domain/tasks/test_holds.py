import pytest

from domain.errors import ReservedHoldError, TooManyHoldsError
from domain.snapshot import HoldView
from domain.tasks.holds import MAX_HOLDS, Holds, why_not_restored


def test_there_is_none_at_first() -> None:
    holds = Holds()

    assert not holds
    assert holds.reason == ""


def test_each_owner_has_one_with_reason_and_time() -> None:
    holds = Holds()
    assert holds.set("operator", "lunch", "http:1", 7)
    hold = holds.views["operator"]

    assert (hold.owner, hold.reason, hold.by, hold.since) == ("operator", "lunch", "http:1", 7)


def test_the_reason_is_that_of_all_in_order_and_a_nameless_one_is_told_by_its_owner() -> None:
    holds = Holds()
    holds.set("gate", "closed", "", 1)
    holds.set("operator", "", "", 2)

    assert holds.reason == "closed; operator"


def test_releasing_what_is_not_held_changes_nothing() -> None:
    holds = Holds()
    holds.set("gate", "closed", "", 1)

    assert not holds.release("operator")
    assert holds


@pytest.mark.parametrize("owner", ["error", "vehicle", "drive_process", "navigation"])
def test_the_names_of_pilothouse_are_reserved(owner: str) -> None:
    with pytest.raises(ReservedHoldError, match=owner):
        Holds().check_set(owner)
    with pytest.raises(ReservedHoldError, match=owner):
        Holds().check_release(owner)


def test_the_hold_of_a_restart_is_released_by_people_and_set_by_nobody() -> None:
    Holds().check_release("restart")
    with pytest.raises(ReservedHoldError, match="only Pilothouse sets the hold 'restart'") as said:
        Holds().check_set("restart")

    assert said.value.hint == "use another name, such as operator"


@pytest.mark.parametrize(
    ("owner", "others", "why"),
    [
        ("gate", MAX_HOLDS - 1, ""),
        ("gate", MAX_HOLDS, f"there are {MAX_HOLDS} holds already"),
        ("vehicle", 0, "only Pilothouse sets a hold of this name"),
        ("restart", 0, "only Pilothouse sets a hold of this name"),
    ],
)
def test_which_holds_are_not_set_again_after_a_restart(owner: str, others: int, why: str) -> None:
    assert why_not_restored(owner, others) == why


def test_one_too_many_is_refused_and_one_that_is_there_is_not() -> None:
    holds = Holds()
    for number in range(MAX_HOLDS):
        holds.set(f"o{number}", "", "", 0)
    holds.check_set("o0")

    with pytest.raises(TooManyHoldsError, match=f"there are {MAX_HOLDS} holds"):
        holds.check_set("another")


def test_a_hold_set_again_takes_the_new_reason_and_keeps_who_set_it_first() -> None:
    holds = Holds()
    holds.set("operator", "lunch", "anna", 7)
    first = holds.views["operator"]

    assert not holds.set("operator", "lunch", "bert", 9)
    assert holds.views["operator"] is first
    assert not holds.set("operator", "still lunch", "bert", 9)
    assert holds.views["operator"] == HoldView("operator", "still lunch", "anna", 7)


def test_releasing_the_last_hold_leaves_none() -> None:
    holds = Holds()
    holds.set("gate", "closed", "", 1)

    assert holds.release("gate")
    assert not holds


def test_a_name_that_is_not_reserved_may_be_used() -> None:
    Holds().check_set("operator")
    Holds().check_release("operator")


def test_the_views_are_another_object_after_each_change_and_only_then() -> None:
    holds = Holds()
    none = holds.views
    holds.set("gate", "closed", "", 1)
    closed = holds.views
    holds.set("gate", "closed", "", 2)
    assert holds.views is closed

    holds.set("gate", "jammed", "", 3)
    jammed = holds.views
    holds.release("operator")
    assert holds.views is jammed

    holds.release("gate")
    assert (len(none), len(holds.views)) == (0, 0)
    assert (closed["gate"].reason, jammed["gate"].reason) == ("closed", "jammed")
