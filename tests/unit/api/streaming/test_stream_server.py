import pytest

from api.app import create_app
from api.http.access import Access
from api.http.gate.refusals import Refusals
from api.http.limits import ServiceLimits
from api.streaming.stream_server import StreamServer, stream_server
from tests.support.live_robot import make_supervisor


def make_server(max_clients: int) -> StreamServer:
    supervisor = make_supervisor()
    return StreamServer(supervisor, max_clients, Access.open(), Refusals(supervisor.clock))


def test_all_who_ask_share_one_server() -> None:
    app = create_app(make_supervisor(), allowed_hosts=[])

    assert stream_server(app) is stream_server(app)


def test_the_limit_is_that_of_the_application() -> None:
    limits = ServiceLimits(stream_clients=1)
    server = stream_server(create_app(make_supervisor(), allowed_hosts=[], limits=limits))

    with server.count_client():
        assert server.is_full


def test_clients_are_counted_while_they_are_there() -> None:
    server = make_server(2)

    with server.count_client(), server.count_client():
        assert (server.clients, server.is_full) == (2, True)

    assert (server.clients, server.is_full) == (0, False)


def test_a_client_that_ends_by_an_error_is_not_counted_any_more() -> None:
    server = make_server(2)

    with pytest.raises(ConnectionError), server.count_client():
        raise ConnectionError

    assert server.clients == 0
