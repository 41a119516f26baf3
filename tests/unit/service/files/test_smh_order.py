import pytest

from domain.state_and_mode import PartName
from service.files.smh_order import Order

A, B, C = PartName("a"), PartName("b"), PartName("c")
AFTER = {C: (A,)}


@pytest.mark.parametrize(
    ("order", "after"),
    [
        pytest.param(Order(), {}, id="nothing: all at once"),
        pytest.param(Order("simultaneous"), {}, id="all at once"),
        pytest.param(Order("sequential"), {B: (A,), C: (B,)}, id="in the order of the file"),
        pytest.param(Order("sequential", (C, A)), {A: (C,)}, id="in sequence"),
        pytest.param(Order(after=AFTER), AFTER, id="as the file says"),
    ],
)
def test_each_way_to_say_an_order_becomes_what_a_part_waits_for(
    order: Order, after: dict[PartName, tuple[PartName, ...]]
) -> None:
    assert order.to_after((A, B, C)) == after


@pytest.mark.parametrize(
    ("own", "every", "filled"),
    [
        pytest.param(Order(), Order("sequential", (B, A)), Order("sequential", (B, A)), id="all"),
        pytest.param(
            Order(sequence=(B, A)), Order("sequential"), Order("sequential", (B, A)), id="one key"
        ),
        pytest.param(
            Order("simultaneous"),
            Order("sequential", (B, A)),
            Order("simultaneous"),
            id="a sequence is no part of another order",
        ),
        pytest.param(
            Order(after=AFTER), Order("sequential", (B, A)), Order(after=AFTER), id="own DAG"
        ),
        pytest.param(Order(), Order(after=AFTER), Order(after=AFTER), id="the DAG of all"),
        pytest.param(
            Order("sequential"), Order(after=AFTER), Order("sequential"), id="own order, no DAG"
        ),
        pytest.param(Order(after={}), Order(after=AFTER), Order(after={}), id="own empty DAG"),
    ],
)
def test_what_a_mode_does_not_say_is_filled_in_unless_it_contradicts(
    own: Order, every: Order, filled: Order
) -> None:
    assert own.filled_from(every) == filled
