import pytest

from api.app import create_app
from api.http.access import Access
from api.http.gate.refusals import Refusals
from api.http.limits import ServiceLimits
from api.streaming.hub import StreamHub, stream_hub
from tests.support.live_robot import make_supervisor


def make_hub(max_clients: int) -> StreamHub:
    supervisor = make_supervisor()
    return StreamHub(supervisor, max_clients, Access.open(), Refusals(supervisor.clock))


def test_all_who_ask_share_one_hub() -> None:
    app = create_app(make_supervisor(), allowed_hosts=[])

    assert stream_hub(app) is stream_hub(app)


def test_the_limit_is_that_of_the_application() -> None:
    limits = ServiceLimits(stream_clients=1)
    hub = stream_hub(create_app(make_supervisor(), allowed_hosts=[], limits=limits))

    with hub.count_client():
        assert hub.is_full


def test_clients_are_counted_while_they_are_there() -> None:
    hub = make_hub(2)

    with hub.count_client(), hub.count_client():
        assert (hub.clients, hub.is_full) == (2, True)

    assert (hub.clients, hub.is_full) == (0, False)


def test_a_client_that_ends_by_an_error_is_not_counted_any_more() -> None:
    hub = make_hub(2)

    with pytest.raises(ConnectionError), hub.count_client():
        raise ConnectionError

    assert hub.clients == 0
