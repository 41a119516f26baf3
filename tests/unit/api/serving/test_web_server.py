import socket
from collections.abc import Iterator

import pytest

from api.serving import web_server
from api.serving.web_server import ListenError, is_loopback, listen, url_of


@pytest.fixture
def taken_port() -> Iterator[int]:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        yield listener.getsockname()[1]


def test_a_free_port_is_taken_and_told() -> None:
    (listener,) = listen("127.0.0.1", 0)

    with listener:
        assert url_of([listener], "127.0.0.1").startswith("http://127.0.0.1:")
        assert not url_of([listener], "127.0.0.1").endswith(":0")


def test_all_addresses_of_a_name_share_one_port() -> None:
    listeners = listen("localhost", 0)

    assert len({listener.getsockname()[1] for listener in listeners}) == 1
    for listener in listeners:
        listener.close()


def test_a_port_in_use_is_told_with_what_to_do(taken_port: int) -> None:
    with pytest.raises(ListenError, match=f"port {taken_port} of 127.0.0.1 is in use.*--port"):
        listen("127.0.0.1", taken_port)


def test_an_address_of_another_machine_is_told() -> None:
    with pytest.raises(ListenError, match=r"cannot listen on port \d+ of 203.0.113.7"):
        listen("203.0.113.7", 8000)


def test_an_unknown_host_is_told() -> None:
    with pytest.raises(ListenError, match="there is no host 'no-such-host"):
        listen("no-such-host.invalid", 0)


@pytest.mark.parametrize("host", ["127.0.0.1", "127.9.9.9", "localhost", "::1"])
def test_these_are_reached_from_this_machine_only(host: str) -> None:
    assert is_loopback(host)


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.0.2.1"])
def test_these_are_reached_from_elsewhere(host: str) -> None:
    assert not is_loopback(host)


def test_who_can_reach_an_unknown_host_cannot_be_told() -> None:
    with pytest.raises(ListenError, match="there is no host"):
        is_loopback("no-such-host.invalid")


@pytest.mark.parametrize(
    ("host", "url"),
    [
        ("::1", "http://[::1]:"),
        ("robot.local", "http://robot.local:"),
    ],
)
def test_the_address_can_be_typed_into_a_browser(host: str, url: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        assert url_of([listener], host).startswith(url)


@pytest.mark.parametrize(("own", "shown"), [("192.168.7.2", "192.168.7.2"), (None, "127.0.0.1")])
def test_a_service_on_all_addresses_shows_the_one_by_which_others_reach_it(
    own: str | None, shown: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(web_server, "_own_address", lambda _: own)
    with socket.create_server(("0.0.0.0", 0)) as listener:
        assert url_of([listener], "0.0.0.0").startswith(f"http://{shown}:")
