"""The last facts about nodes and signals."""

from domain.inputs import (
    CheckpointReport,
    ErrorReport,
    NodeReport,
    ReactionReport,
    Reading,
    Readings,
    SourceFault,
)
from domain.lifecycle import LifecycleState
from domain.link.facts import Facts, difference, merged
from domain.link.messages import Told
from domain.reaction_terms import ReactionState
from domain.state_and_mode import ModeName
from domain.timebase import seconds
from tests.support.linked_pair import DRIVE

S = LifecycleState
FAST = ModeName("FAST")


def known(*told: Told) -> list[Told]:
    facts = Facts()
    for number, each in enumerate(told):
        facts.note(each, seconds(number))
    return list(facts.all())


def test_a_reaction_stands_as_it_was_told_last() -> None:
    acting = ReactionReport(DRIVE, "COOL", ReactionState.ACTING)
    idle = ReactionReport(DRIVE, "COOL", ReactionState.IDLE)
    facts = Facts()
    for told in (idle, acting):
        facts.note(told, 0)

    assert list(facts.all()) == [acting]
    assert acting in facts
    assert idle not in facts


def test_reports_of_a_node_add_up() -> None:
    assert known(
        NodeReport(DRIVE, S.ACTIVE, parameters={"max_speed": 1.0, "gain": 2}),
        NodeReport(DRIVE, mode=FAST),
        NodeReport(DRIVE, parameters={"max_speed": 2.0}, has_lifecycle=True),
    ) == [NodeReport(DRIVE, S.ACTIVE, FAST, {"max_speed": 2.0, "gain": 2}, True, True)]


def test_a_node_that_leaves_active_loses_its_mode() -> None:
    active = merged(None, NodeReport(DRIVE, S.ACTIVE, FAST))

    assert merged(active, NodeReport(DRIVE, S.INACTIVE)).mode is None
    assert merged(active, NodeReport(DRIVE, S.ACTIVE)).mode == FAST


def test_a_node_that_is_unreachable_stays_so_until_it_is_said_to_be_reachable() -> None:
    gone = merged(None, NodeReport(DRIVE, reachable=False))

    assert merged(gone, NodeReport(DRIVE, S.ACTIVE)).reachable is False
    assert merged(gone, NodeReport(DRIVE, reachable=True)).reachable is True


def test_of_each_signal_the_last_reading_by_source_is_kept_with_its_time() -> None:
    assert known(
        Readings((Reading("load", 0.1), Reading("estop", False)), "can"),
        Readings((Reading("load", 0.2, stamp=seconds(0.5)),), "can"),
        Readings((Reading("load", 0.3),), "serial"),
    ) == [
        Readings((Reading("load", 0.2, seconds(0.5)),), "can"),
        Readings((Reading("estop", False, 0),), "can"),
        Readings((Reading("load", 0.3, seconds(2)),), "serial"),
    ]


def test_a_fault_of_a_source_ends_with_its_next_reading() -> None:
    fault = SourceFault("load", "can", "no bus")

    assert known(fault) == [fault]
    assert not any(isinstance(each, SourceFault) for each in known(fault, _load(0.1)))


def test_the_last_report_of_an_error_is_kept_and_what_is_of_a_moment_is_not() -> None:
    over = ErrorReport(DRIVE, "JAMMED", active=False)

    assert known(
        ErrorReport(DRIVE, "JAMMED", active=True), over, CheckpointReport(DRIVE, "done")
    ) == [over]


def test_what_is_known_can_be_asked() -> None:
    facts = Facts()
    fault, error = SourceFault("load", "can", "no bus"), ErrorReport(DRIVE, "JAMMED", active=True)
    for told in (_load(0.1), fault, error):
        facts.note(told, seconds(1))

    assert facts.reading("can", "load") == (Reading("load", 0.1), seconds(1))
    assert facts.reading("can", "estop") is None
    assert fault in facts
    assert error in facts
    assert SourceFault("load", "can", "other") not in facts
    assert _load(0.1) not in facts


def test_what_is_remembered_is_bounded() -> None:
    facts = Facts()
    for number in range(10_000):
        name = f"s{number}"
        facts.note(Readings((Reading(name, 1.0),), "can"), 0)
        facts.note(SourceFault(name, "serial", ""), 0)
        facts.note(ErrorReport(DRIVE, name, active=True), 0)

    assert len(list(facts.all())) == 3 * 4_096


# --- what must be told for complete facts to be known --------------------------------------------

ACTIVE = merged(None, NodeReport(DRIVE, S.ACTIVE, FAST, {"gain": 2}, True))


def test_what_is_known_is_not_told_again() -> None:
    assert difference(ACTIVE, ACTIVE) is None


def test_only_what_differs_is_told() -> None:
    slower = merged(ACTIVE, NodeReport(DRIVE, S.INACTIVE, parameters={"gain": 3, "max": 1.0}))

    assert difference(ACTIVE, slower) == NodeReport(
        DRIVE, S.INACTIVE, parameters={"gain": 3, "max": 1.0}
    )


def test_a_parameter_of_another_type_differs() -> None:
    other = merged(ACTIVE, NodeReport(DRIVE, parameters={"gain": 2.0}))

    assert difference(ACTIVE, other) == NodeReport(DRIVE, parameters={"gain": 2.0})


def test_of_a_node_that_was_not_reachable_all_facts_are_told() -> None:
    gone = merged(ACTIVE, NodeReport(DRIVE, reachable=False))

    assert difference(gone, ACTIVE) == ACTIVE
    assert difference(None, ACTIVE) == ACTIVE
    assert difference(gone, gone) is None


def test_a_node_that_is_no_longer_reachable_is_told() -> None:
    gone = merged(ACTIVE, NodeReport(DRIVE, reachable=False))

    assert difference(ACTIVE, gone) == NodeReport(DRIVE, reachable=False)


def _load(value: float) -> Readings:
    return Readings((Reading("load", value),), "can")
