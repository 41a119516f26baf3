import pytest
from starlette.requests import ClientDisconnect
from starlette.types import Receive, Scope, Send

from api.http.gate.faults import UnexpectedErrors
from tests.support.asgi import messages_of, websocket_scope
from tests.support.http_robot import http_scope


async def test_a_fault_is_answered_without_its_inside_and_logged_with_it(
    caplog: pytest.LogCaptureFixture,
) -> None:
    sent = await messages_of(UnexpectedErrors(fail), http_scope("GET", "/x"))

    assert sent[0]["status"] == 500
    assert b"INTERNAL" in sent[1]["body"]
    assert b"secret" not in sent[1]["body"]
    assert "secret" in caplog.text


async def test_a_fault_after_the_answer_has_begun_is_left_to_the_server() -> None:
    with pytest.raises(ValueError, match="secret"):
        await messages_of(UnexpectedErrors(fail_late), http_scope("GET", "/x"))


async def test_a_fault_in_a_websocket_is_left_to_the_server() -> None:
    with pytest.raises(ValueError, match="secret"):
        await messages_of(UnexpectedErrors(fail), websocket_scope({}))


async def fail(scope: Scope, receive: Receive, send: Send) -> None:
    raise ValueError("secret")


async def fail_late(scope: Scope, receive: Receive, send: Send) -> None:
    await send({"type": "http.response.start", "status": 200, "headers": []})
    raise ValueError("secret")


async def test_a_client_that_goes_in_the_middle_of_its_upload_is_no_fault(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def read(scope: Scope, receive: Receive, send: Send) -> None:
        raise ClientDisconnect

    with caplog.at_level("INFO"):
        assert await messages_of(UnexpectedErrors(read), http_scope("POST", "/tasks")) == []

    (record,) = caplog.records
    assert record.exc_info is None
    assert "10.0.0.1" in record.getMessage()
