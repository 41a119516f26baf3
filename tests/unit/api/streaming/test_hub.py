import pytest

import api.streaming.hub
from api.app import create_app
from api.streaming.hub import StreamHub, stream_hub
from tests.support.live_robot import make_supervisor


def test_all_who_ask_share_one_hub() -> None:
    app = create_app(make_supervisor(), allowed_hosts=[])

    assert stream_hub(app) is stream_hub(app)


def test_clients_are_counted_while_they_are_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(api.streaming.hub, "MAX_CLIENTS", 2)
    hub = StreamHub(make_supervisor())

    with hub.count_client(), hub.count_client():
        assert (hub.clients, hub.is_full) == (2, True)

    assert (hub.clients, hub.is_full) == (0, False)


def test_a_client_that_ends_by_an_error_is_not_counted_any_more() -> None:
    hub = StreamHub(make_supervisor())

    with pytest.raises(ConnectionError), hub.count_client():
        raise ConnectionError

    assert hub.clients == 0
