"""One request with the standard library."""

import http.server
import json
import socket
import threading
from collections.abc import Iterator
from typing import Any

import pytest

from api.client.address import Address
from api.client.bare_request import bare_request
from api.client.outcomes import NoAnswerError, NoConnectionError


class _Handler(http.server.BaseHTTPRequestHandler):
    asked: list[tuple[str, str, str | None, bytes]]
    status = 200
    content = b'{"engaged": true}'

    def do_PUT(self) -> None:
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        self.asked.append((self.command, self.path, self.headers.get("Authorization"), body))
        self.send_response(self.status)
        self.send_header("Pilothouse-Durable", "false")
        self.send_header("Content-Length", str(len(self.content)))
        self.end_headers()
        self.wfile.write(self.content)

    do_GET = do_PUT  # noqa: N815

    def log_message(self, *_: object) -> None:
        """Say nothing."""


@pytest.fixture
def handler() -> Iterator[Any]:
    class Handler(_Handler):
        asked: list[tuple[str, str, str | None, bytes]] = []  # noqa: RUF012

    with http.server.HTTPServer(("127.0.0.1", 0), Handler) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        Handler.url = f"http://127.0.0.1:{server.server_port}/robot"  # type: ignore[attr-defined]
        yield Handler
        server.shutdown()
        thread.join()


def test_a_request_has_the_token_and_the_path_below_that_of_the_address(handler: Any) -> None:  # noqa: ANN401
    address = Address.of(handler.url, "secret")

    answer = bare_request(address, "PUT", "/emergency_stop", 5, {"engaged": True})

    assert (answer.status, answer.body, answer.is_volatile) == (200, {"engaged": True}, True)
    method, path, token, body = handler.asked[0]
    assert (method, path, token) == ("PUT", "/robot/emergency_stop", "Bearer secret")
    assert json.loads(body) == {"engaged": True}


def test_a_proxy_of_the_environment_is_passed_by(
    handler: Any,  # noqa: ANN401
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("HTTP_PROXY", "http://127.0.0.1:1")

    assert bare_request(Address.of(handler.url), "GET", "/vehicle", 5).status == 200


def test_a_rejection_is_an_answer(handler: Any) -> None:  # noqa: ANN401
    handler.status, handler.content = 401, b'{"detail": "who are you?"}'

    assert bare_request(Address.of(handler.url), "GET", "/vehicle", 5).status == 401


@pytest.mark.parametrize("content", [b"<html>", b"[]", b""])
def test_what_is_no_json_object_is_not_pilothouse(handler: Any, content: bytes) -> None:  # noqa: ANN401
    handler.content = content

    with pytest.raises(NoAnswerError, match="is not Pilothouse"):
        bare_request(Address.of(handler.url), "GET", "/vehicle", 5)


def test_where_nobody_listens_nothing_was_sent() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]

    with pytest.raises(NoConnectionError, match="is it running"):
        bare_request(Address.of(f"http://127.0.0.1:{port}"), "GET", "/vehicle", 5)


@pytest.mark.parametrize("host", ["no.such.host.invalid", "a" * 70])
def test_a_host_that_there_cannot_be_is_no_connection(host: str) -> None:
    with pytest.raises(NoConnectionError):
        bare_request(Address.of(f"http://{host}"), "GET", "/vehicle", 5)


def test_a_service_that_hangs_is_left_after_the_time() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        address = Address.of(f"http://127.0.0.1:{listener.getsockname()[1]}")
        with pytest.raises(NoAnswerError, match="timed out") as left:
            bare_request(address, "GET", "/vehicle", 0.05)

    assert not isinstance(left.value, NoConnectionError)
