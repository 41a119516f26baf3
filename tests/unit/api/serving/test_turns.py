from api.serving.turns import BUDGET, RECENT_TURNS, Turns, Urgency
from tests.support.flooded_wire import CountedLoop

COST = 500


class Client:
    """Has so many pieces that wait."""

    def __init__(self, turns: Turns, pieces: int, urgency: Urgency = Urgency.REST) -> None:
        self.pieces = pieces
        self.urgency = urgency
        self.served = 0
        self.served_in = -RECENT_TURNS
        self._turns = turns

    def serve(self) -> int:
        if not self.pieces:
            return 0
        self.pieces -= 1
        self.served += 1
        self.served_in = self._turns.number
        return COST


class Clients:
    """Turns, and clients that wait for them."""

    def __init__(self) -> None:
        self.loop = CountedLoop()
        self.turns = Turns(self.loop.call_soon)

    def wait(self, count: int, pieces: int, urgency: Urgency = Urgency.REST) -> list[Client]:
        """Let so many clients wait."""
        clients = [Client(self.turns, pieces, urgency) for _ in range(count)]
        for client in clients:
            self.turns.wait(client)
        return clients

    def pass_turns(self, count: int) -> None:
        for _ in range(count):
            self.loop.turn()


def test_all_connections_together_get_one_budget_per_turn() -> None:
    clients = Clients()
    flood = clients.wait(110, 1_000)

    for number in range(1, 100):
        clients.pass_turns(1)
        assert sum(client.served for client in flood) == number * BUDGET // COST

    counts = {client.served for client in flood}
    assert max(counts) - min(counts) <= 1


def test_a_single_request_does_not_wait_behind_those_that_send_without_end() -> None:
    clients = Clients()
    clients.wait(110, 1_000)
    clients.pass_turns(110)

    (late,) = clients.wait(1, 1)
    clients.pass_turns(1)

    assert late.served == 1


def test_whoever_waits_for_each_answer_has_had_its_share_too() -> None:
    """Such clients begin to wait anew with every request, as a single one does."""
    clients = Clients()
    flood = clients.wait(110, 1)
    for _ in range(100):
        clients.pass_turns(1)
        for client in flood:
            if not client.pieces:
                client.pieces = 1
                clients.turns.wait(client)

    (late,) = clients.wait(1, 1)
    clients.pass_turns(2)

    assert late.served == 1


def test_a_stop_comes_before_all_who_have_just_come() -> None:
    clients = Clients()
    clients.wait(110, 1)

    (stop,) = clients.wait(1, 1, Urgency.STOP)
    clients.pass_turns(1)

    assert stop.served == 1


def test_a_stop_comes_before_all_who_have_just_come_to_hold_the_vehicle() -> None:
    clients = Clients()
    clients.wait(50, 1, Urgency.PAUSE)

    (stop,) = clients.wait(1, 1, Urgency.STOP)
    clients.pass_turns(1)

    assert stop.served == 1


def test_a_stop_does_not_wait_behind_those_that_stop_without_end() -> None:
    clients = Clients()
    clients.wait(110, 1_000, Urgency.STOP)
    clients.pass_turns(110)

    (stop,) = clients.wait(1, 1, Urgency.STOP)
    clients.pass_turns(1)

    assert stop.served == 1


def test_nobody_waits_forever_behind_those_that_come_first() -> None:
    """Each turn there are more new clients, urgent and not, than one turn can serve."""
    clients = Clients()
    patient = clients.wait(3, 1_000)
    urgent = clients.wait(3, 1_000, Urgency.STOP)
    clients.pass_turns(10)
    before = [client.served for client in (*patient, *urgent)]

    for _ in range(40):
        clients.wait(10, 1, Urgency.STOP)
        clients.wait(10, 1)
        clients.pass_turns(1)

    after = [client.served for client in (*patient, *urgent)]
    assert min(now - then for now, then in zip(after, before, strict=True)) >= 3


def test_what_is_done_at_once_counts_in_the_same_turn() -> None:
    clients = Clients()

    clients.turns.spend(BUDGET)
    assert not clients.turns.has_room
    clients.pass_turns(1)

    assert clients.turns.has_room
    assert clients.loop.is_idle
