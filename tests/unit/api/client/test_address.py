import pytest

from api.client.address import Address
from api.client.outcomes import NoAnswerError


@pytest.mark.parametrize(
    ("url", "stream"),
    [
        ("http://127.0.0.1:8000", "ws://127.0.0.1:8000/ws"),
        ("http://robot:8000/", "ws://robot:8000/ws"),
        ("https://fleet.local/robots/7", "wss://fleet.local/robots/7/ws"),
    ],
)
def test_the_stream_is_beside_the_interface(url: str, stream: str) -> None:
    assert Address.of(url).stream_url((), None, 0) == stream


def test_events_go_on_behind_the_one_that_is_known() -> None:
    address = Address.of("http://robot:8000")

    assert address.stream_url((), "c20a", 88) == "ws://robot:8000/ws?after=88&epoch=c20a"


def test_a_client_subscribes_to_the_topics_that_it_needs() -> None:
    address = Address.of("http://robot:8000")
    topics = ("task", "vehicle")

    assert address.stream_url(topics, None, 0) == "ws://robot:8000/ws?topics=task,vehicle"
    assert address.stream_url(topics, "c20a", 88) == (
        "ws://robot:8000/ws?topics=task,vehicle&after=88&epoch=c20a"
    )


@pytest.mark.parametrize(
    "url", ["", "robot", "robot:8000", "ftp://robot", "http://", "http://robot:x", "http://[::1"]
)
def test_what_is_no_address_is_told(url: str) -> None:
    with pytest.raises(NoAnswerError, match="invalid address"):
        Address.of(url)


def test_the_token_goes_along_and_is_never_shown() -> None:
    address = Address.of("http://robot:8000", "s3cret")

    assert address.headers == {"Authorization": "Bearer s3cret"}
    assert "s3cret" not in repr(address)


def test_without_a_token_nothing_goes_along() -> None:
    assert Address.of("http://robot:8000").headers == {}


@pytest.mark.parametrize(
    ("url", "place"),
    [
        ("http://127.0.0.1:8123", ("127.0.0.1", 8123)),
        ("http://localhost", ("localhost", 80)),
        ("https://[::1]", ("::1", 443)),
        ("http://robot:8000", None),
    ],
)
def test_this_machine_is_reached_past_any_proxy(url: str, place: tuple[str, int] | None) -> None:
    assert Address.of(url).loopback == place
