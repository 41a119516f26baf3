from api.serving.turns import BUDGET, Turns
from tests.support.flooded_wire import CountedLoop

COST = 500


class Client:
    """Has so many pieces that wait."""

    def __init__(self, pieces: int, *, is_urgent: bool = False) -> None:
        self.pieces = pieces
        self.is_urgent = is_urgent
        self.served = 0

    def serve(self) -> int:
        if not self.pieces:
            return 0
        self.pieces -= 1
        self.served += 1
        return COST


def test_all_connections_together_get_one_budget_per_turn() -> None:
    loop = CountedLoop()
    turns = Turns(loop.call_soon)
    clients = [Client(1_000) for _ in range(110)]
    for client in clients:
        turns.wait(client)

    for number in range(1, 100):
        loop.turn()
        assert sum(client.served for client in clients) == number * BUDGET // COST

    counts = {client.served for client in clients}
    assert max(counts) - min(counts) <= 1


def test_a_single_request_does_not_wait_behind_those_that_send_without_end() -> None:
    loop = CountedLoop()
    turns = Turns(loop.call_soon)
    for _ in range(110):
        turns.wait(Client(1_000))
    for _ in range(110):
        loop.turn()

    late = Client(1)
    turns.wait(late)
    loop.turn()

    assert late.served == 1


def test_a_stop_comes_before_all_who_have_just_come() -> None:
    loop = CountedLoop()
    turns = Turns(loop.call_soon)
    for _ in range(110):
        turns.wait(Client(1))
    stop = Client(1, is_urgent=True)

    turns.wait(stop)
    loop.turn()

    assert stop.served == 1


def test_what_is_done_at_once_counts_in_the_same_turn() -> None:
    loop = CountedLoop()
    turns = Turns(loop.call_soon)

    turns.spend(BUDGET)
    assert not turns.has_room
    loop.turn()

    assert turns.has_room
    assert loop.is_idle
