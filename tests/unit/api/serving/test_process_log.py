import json
import logging
from urllib.parse import quote

import pytest
from hypothesis import given
from hypothesis import strategies as st

from api.serving.process_log import (
    INTERVAL_S,
    MAX_RECORDS,
    LimitedHandler,
    LineFormat,
    is_for_operators,
)

TOKEN = 'p"\\l%thouse<secret>-0123456789'
LEVELS = st.sampled_from([logging.DEBUG, logging.INFO, logging.WARNING, logging.ERROR])


class Log:
    """The log of a process, with the lines that it wrote."""

    def __init__(self, token: str | None = TOKEN) -> None:
        self.now = 0.0
        self.text = ""
        self.handler = LimitedHandler(self._write, lambda: self.now)
        self.handler.setFormatter(LineFormat(token))

    @property
    def lines(self) -> list[str]:
        """What was written, without the times."""
        return [line.split(" ", 2)[-1] for line in self.text.splitlines()]

    def take(
        self,
        words: str,
        *arguments: object,
        line: int = 1,
        level: int = logging.WARNING,
        error: BaseException | None = None,
    ) -> None:
        failure = None if error is None else (type(error), error, None)
        record = logging.LogRecord("api.x", level, "x.py", line, words, arguments, failure)
        self.handler.handle(record)

    def _write(self, text: str) -> None:
        self.text += text


def test_a_flood_is_cut_and_its_rest_is_counted_with_the_last_address() -> None:
    log = Log()
    for number in range(MAX_RECORDS + 312):
        log.take("refused %s", f"10.0.0.{number}")
    log.now = INTERVAL_S
    log.take("something else", line=2)

    last = MAX_RECORDS + 311
    assert log.lines[MAX_RECORDS:] == [
        f"WARNING api.x: and 312 more like this, the last: refused 10.0.0.{last}",
        "WARNING api.x: something else",
    ]


def test_the_end_of_the_process_tells_the_rest_too() -> None:
    log = Log()
    for _ in range(MAX_RECORDS + 2):
        log.take("refused")
    log.handler.close()

    assert log.lines[-1] == "WARNING api.x: and 2 more like this, the last: refused"


def test_one_kind_does_not_hide_another_and_what_is_critical_is_always_written() -> None:
    log = Log()
    for _ in range(MAX_RECORDS + 5):
        log.take("flood")
        log.take("the end is near", line=2, level=logging.CRITICAL)
    log.take("rare", line=3)

    assert log.lines.count("WARNING api.x: flood") == MAX_RECORDS
    assert log.lines.count("CRITICAL api.x: the end is near") == MAX_RECORDS + 5
    assert log.lines[-1] == "WARNING api.x: rare"


def test_tracebacks_use_up_the_limit_sooner() -> None:
    log = Log()
    for _ in range(100):
        log.take("failed", error=ValueError("no"))

    assert log.text.count("failed") == MAX_RECORDS // 5


def test_a_client_cannot_forge_a_line() -> None:
    log = Log()
    log.take("GET %s failed", "/\n2026-01-01 CRITICAL api: all is lost\r\x1b[2J\u202e\ud800")

    (line,) = log.text.splitlines()
    assert line.endswith(r"/\n2026-01-01 CRITICAL api: all is lost\r\x1b[2J\u202e\ud800 failed")


def test_a_long_message_is_cut() -> None:
    log = Log()
    log.take("%s", "x" * 1_000_000)

    assert len(log.text) < 2_100


def test_the_token_of_another_service_is_hidden_too() -> None:
    log = Log(token=None)
    log.take("headers: %s", [("Authorization", "Bearer abc-123")])

    assert "abc-123" not in log.text
    assert "[token]" in log.text


@pytest.mark.parametrize("name", ["uvicorn.error", "websockets.server", "httpcore", "asyncio"])
def test_what_libraries_say_while_one_debugs_is_not_for_operators(name: str) -> None:
    def record(name: str, level: int) -> logging.LogRecord:
        return logging.LogRecord(name, level, "x.py", 1, "< Authorization: Bearer x", (), None)

    assert not is_for_operators(record(name, logging.DEBUG))
    assert is_for_operators(record(name, logging.WARNING))
    assert is_for_operators(record("service.ros.gateway", logging.DEBUG))


def test_arguments_that_do_not_fit_end_nothing() -> None:
    log = Log()
    log.take("%d", "no number")
    log.take("next", line=2)

    assert log.lines[-1] == "WARNING api.x: next"
    assert "a record cannot be written" in log.text


@pytest.mark.parametrize("level", [logging.DEBUG, logging.ERROR])
def test_a_token_across_the_cut_is_hidden_as_a_whole(level: int) -> None:
    log = Log()
    log.take("%s%s", "x" * 1_995, TOKEN, level=level)

    assert TOKEN[:5] not in log.text


@given(st.text(), st.text(), LEVELS, st.booleans())
def test_whatever_is_logged_never_holds_the_token(
    before: str, after: str, level: int, fails: bool
) -> None:
    log = Log()
    said = f"{before}{TOKEN}{after}"
    ways: list[object] = [said, [said], {"a": said}, said.encode("utf-8", "replace")]
    ways += [json.dumps(said), quote(said, errors="replace"), f"?token={TOKEN}&x"]
    for line, way in enumerate(ways):
        log.take("%s", way, line=line, level=level, error=ValueError(way) if fails else None)

    for form in (TOKEN, repr(TOKEN)[1:-1], json.dumps(TOKEN)[1:-1], quote(TOKEN)):
        assert form not in log.text
