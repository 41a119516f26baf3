from domain.actor import Actor
from domain.conditions.watched import WatchedConditions
from domain.reactions.displacer import key_of
from domain.reactions.reaction import Reaction, reactions_of
from domain.snapshot import Because
from service.files.model_file import read_model
from tests.support.reacting_robot import HALT, LIMP, REST, flag_signals, reacting_text
from tests.support.told_facts import ToldFacts


def reactions(*lines: str, **facts: bool) -> list[Reaction]:
    model = read_model(reacting_text(*lines), flag_signals()).model
    told = ToldFacts({"a": False, "b": False, "c": False, **facts})
    return reactions_of(model, WatchedConditions(told), 0)


def test_a_reaction_is_known_by_its_part_its_name_and_its_target() -> None:
    limp, rest, halt = reactions(LIMP, REST, HALT)

    assert key_of(limp) == (Because.REACTION, "carrier", "LIMP", limp.new_target)
    assert (limp.key, limp.actor, halt.hold) == (
        "carrier.LIMP",
        Actor("reaction:LIMP"),
        "reaction:HALT",
    )
    assert {rest.strength, limp.strength, halt.strength} == {
        *sorted([limp.strength, rest.strength, halt.strength])
    }
    assert limp.strength < rest.strength < halt.strength


def test_a_reaction_is_explained_by_its_condition() -> None:
    (limp,) = reactions(LIMP, a=True)

    blocker = limp.cause(7)
    assert (blocker.code, blocker.message, blocker.path, blocker.since) == (
        "REACTION",
        "reaction LIMP of carrier: a",
        ("carrier",),
        7,
    )
    assert [cause.condition for cause in blocker.causes] == ["a"]
    assert not blocker.root_cause


def test_one_whose_condition_is_over_waits_for_a_person() -> None:
    (limp,) = reactions(LIMP)

    (why,) = limp.why()
    assert (why.code, why.message) == (
        "ACKNOWLEDGE",
        "its condition is no longer true: a; nobody has acknowledged it",
    )


def test_a_hold_wants_no_target_of_any_part() -> None:
    (halt,) = reactions(HALT)

    assert halt.targets == {}
