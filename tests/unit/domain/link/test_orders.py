"""Commands of the supervisor, as a device judges them."""

from domain.commands import AskFacts
from domain.computers import SUPERVISOR, Incarnation, Session
from domain.link.messages import NodeOrder
from domain.link.orders import Orders
from domain.state_and_mode import PartName
from tests.support.linked_pair import DRIVE, GRIPPER

FIRST, SECOND = Incarnation("1"), Incarnation("2")
SESSION = Session("s")


def order(
    seq: int,
    process: Incarnation = FIRST,
    session: Session = SESSION,
    node: PartName = DRIVE,
) -> NodeOrder:
    return NodeOrder(SUPERVISOR, process, seq, session, AskFacts(100 + seq, node))


def orders() -> Orders:
    made = Orders({DRIVE})
    made.follow(FIRST)
    return made


def test_a_command_counts_once_and_none_after_a_later_one() -> None:
    device = orders()

    assert [device.is_next(order(seq)) for seq in (1, 1, 3, 2, 4)] == [
        True,
        False,
        True,
        False,
        True,
    ]


def test_a_command_of_a_process_that_is_not_followed_does_not_count() -> None:
    device = orders()

    assert not device.is_next(order(1, SECOND))


def test_the_numbers_of_another_process_begin_anew() -> None:
    device = orders()
    device.is_next(order(7))
    device.take(order(7))
    device.follow(SECOND)

    assert device.is_next(order(1, SECOND))
    assert not device.is_taken(107), "the answer would be taken for one to another request"


def test_a_command_is_carried_out_under_the_present_session_and_by_its_own_node() -> None:
    device = orders()

    assert device.find_refusal(order(1), SESSION) is None
    assert device.find_refusal(order(2), Session("t")) == (
        "it was sent before the connection to the supervisor was lost"
    )
    assert device.find_refusal(order(3, node=GRIPPER), SESSION) == (
        "manipulator is not a node of this device"
    )


def test_what_was_taken_can_be_answered_also_under_a_later_session() -> None:
    device = orders()
    device.follow(FIRST)
    device.take(order(1))
    device.follow(FIRST)

    assert device.is_taken(101)
    assert not device.is_taken(102)
