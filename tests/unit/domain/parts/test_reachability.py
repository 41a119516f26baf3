from domain.parts.reachability import Reachability
from tests.support.models import ACTUATION, ARM, BASE, actuation_model


def test_no_node_can_be_reached_before_it_was_heard_from() -> None:
    reachability = Reachability(actuation_model())

    assert not reachability.reaches(BASE)
    assert not reachability.reaches(ACTUATION)


def test_a_system_is_reached_once_all_its_nodes_are() -> None:
    reachability = Reachability(actuation_model())

    assert reachability.note(BASE, reachable=True)
    assert not reachability.reaches(ACTUATION)
    assert reachability.note(ARM, reachable=True)
    assert reachability.reaches(ACTUATION)

    assert reachability.note(BASE, reachable=False)
    assert not reachability.reaches(ACTUATION)
    assert reachability.reaches(ARM)


def test_what_was_known_is_no_news() -> None:
    reachability = Reachability(actuation_model())
    reachability.note(BASE, reachable=True)

    assert not reachability.note(BASE, reachable=True)
    assert not reachability.note(ARM, reachable=False)
