"""What clients may send, well-formed and not: frames, heads and bodies, as strategies."""

from collections.abc import Iterator
from itertools import cycle

from hypothesis import strategies as st

from tests.support.floods.flood import websocket_handshake

TOKEN = "a-token-of-24-characters"
HOST = b"Host: robot\r\n"
MAX_BYTES = 400_000
"""Of one stream."""
_KEY = f"Authorization: Bearer {TOKEN}\r\n".encode()


def repeated(
    part: st.SearchStrategy[bytes], most: int = 5_000, count: int = 4
) -> st.SearchStrategy[bytes]:
    """Return some parts, each many times in a row."""
    many = st.tuples(part, st.one_of(st.integers(1, 4), st.integers(1, most)))
    return st.lists(many, min_size=1, max_size=count).map(
        lambda parts: b"".join(
            part * min(n, 1 + MAX_BYTES // max(1, len(part))) for part, n in parts
        )
    )


# --- frames --------------------------------------------------------------------------------------

_MESSAGES = (
    b"",
    b"{}",
    b"\xff\xfe",
    b'{"type": "resync"}',
    b'{"type": "reading", "signal": "temperature", "value": 20}',
    b'{"type": "reading", "signal": "temperature", "value": ' + b"9" * 1_000 + b"}",
    f'{{"type": "auth", "token": "{TOKEN}"}}'.encode(),
    f'{{"op": "auth", "token": "{TOKEN}"}}'.encode(),
    b'{"type": "auth", "token": "wrong"}',
    b'{"op": "subscribe", "topic": "/system_state"}',
    b'{"op": "call_service", "service": "/rosapi/topics", "id": "1"}',
    b'{"op": "publish", "topic": "/temperature", "msg": {"data": 20}}',
    b'{"op": "fragment", "id": "1", "data": "{", "num": 0, "total": 1000000}',
    b"[" * 2_000,
    b'{"type": ' + b'{"a": ' * 500,
    b"a" * 126,
    b"a" * 5_000,
    b"a" * 70_000,
)


def _frame(first: int, payload: bytes, lies: int | None, *, is_masked: bool) -> bytes:
    """Return a frame whose length may be a lie."""
    length = len(payload) if lies is None else lies
    flag = 0x80 if is_masked else 0
    if length < 126:
        head = bytes((first, flag | length))
    elif length < 1 << 16:
        head = bytes((first, flag | 126)) + length.to_bytes(2, "big")
    else:
        head = bytes((first, flag | 127)) + length.to_bytes(8, "big")
    return head + (b"\0\0\0\0" if is_masked else b"") + payload


_FIRST_BYTES = st.one_of(
    st.sampled_from([0x81, 0x82, 0x88, 0x89, 0x8A, 0x00, 0x01, 0x02, 0x80]), st.integers(0, 255)
)
_LIES = st.one_of(
    st.none(), st.none(), st.none(), st.sampled_from([125, 126, 65_535, 1 << 20, (1 << 63) - 1])
)
FRAMES = st.builds(
    _frame,
    _FIRST_BYTES,
    st.one_of(st.sampled_from(_MESSAGES), st.binary(max_size=130)),
    _LIES,
    is_masked=st.sampled_from([True, True, True, False]),
)


def _handshake(path: str, key: bytes) -> bytes:
    return websocket_handshake(path).replace(b"Host: 127.0.0.1\r\n", HOST + key)


HANDSHAKES = st.builds(
    _handshake,
    st.sampled_from(["/ws", "/ws?after=0", "/ws?topics=nothing", "/rosbridge", "/nothing"]),
    st.sampled_from([b"", _KEY]),
)
SOCKETS = st.builds(lambda handshake, frames: [handshake, frames], HANDSHAKES, repeated(FRAMES))
"""What is sent at first, and what once that was answered."""


# --- heads ---------------------------------------------------------------------------------------

_METHODS = (
    b"GET",
    b"PUT",
    b"DELETE",
    b"HEAD",
    b"OPTIONS",
    b"CONNECT",
    b"BREW",
    b"get",
    b"",
    b"\xff",
)
_TARGETS = (
    b"/livez",
    b"/metrics",
    b"/events?limit=1000",
    b"/nodes/" + b"a/" * 2_000,
    b"/nodes/" + b"a/" * 15_000,
    b"/nodes/" + b"%41" * 1_300,
    b"/events?" + b"a&" * 4_000,
    b"/\xff\xfe",
    b"http://robot/livez",
    b"*",
    b"",
)
_HEADERS = (
    HOST,
    _KEY,
    b"a: b\r\n",
    b" folded\r\n",
    b"a: b\n",
    b"a\r\n",
    b": b\r\n",
    b"a: \xff\xfe\r\n",
    b"a: " + b"b" * 5_000 + b"\r\n",
    b"Content-Length: 3\r\n",
    b"Content-Length: 18446744073709551615\r\n",
    b"Content-Length: -1\r\n",
    b"Transfer-Encoding: chunked\r\n",
    b"Transfer-Encoding: gzip\r\n",
    b"Expect: 100-continue\r\n",
    b"Connection: close\r\n",
    b"Connection: Upgrade\r\nUpgrade: websocket\r\n",
    b"Connection: Upgrade\r\nUpgrade: h2c\r\n",
)
_HEAD = st.builds(
    lambda method, target, version, headers, end: (
        method + b" " + target + b" " + version + headers + end
    ),
    st.sampled_from(_METHODS),
    st.sampled_from(_TARGETS),
    st.sampled_from(
        [b"HTTP/1.1\r\n", b"HTTP/1.1\r\n", b"HTTP/1.0\r\n", b"HTTP/2.0\r\n", b"\n", b""]
    ),
    st.one_of(st.just(HOST), repeated(st.sampled_from(_HEADERS), 3_000)),
    st.sampled_from([b"\r\n", b"\r\n", b"\n", b""]),
)
_PLAIN = st.sampled_from(_TARGETS).map(
    lambda target: b"GET " + target + b" HTTP/1.1\r\n" + HOST + _KEY + b"\r\n"
)
_CHUNKS = st.sampled_from(
    [
        b"1\r\na\r\n",
        b"1;" + b"a=b;" * 100 + b"\r\na\r\n",
        b"ffff\r\n",
        b"fffffffffffffffff\r\n",
        b"4\r\n\r\n\r\n\r\n",
        b"0\r\n",
        b"0\r\n\r\n",
        b"a: b\r\n",
        b"\r\n",
        b"z",
        b"GET /livez HTTP/1.1\r\n" + HOST + b"\r\n",
    ]
)
_CHUNKED = repeated(_CHUNKS).map(
    lambda chunks: (
        b"PUT /emergency_stop HTTP/1.1\r\n"
        + HOST
        + _KEY
        + b"Transfer-Encoding: chunked\r\n\r\n"
        + chunks
    )
)
HEADS = st.one_of(repeated(st.one_of(_HEAD, _PLAIN)), _CHUNKED, st.binary(max_size=300)).map(
    lambda data: [data]
)


# --- bodies --------------------------------------------------------------------------------------

_ROUTES = (
    b"PUT /emergency_stop",
    b"PUT /holds/flood",
    b"POST /signals",
    b"POST /signals/temperature",
    b"PATCH /mock/temperature",
    b"POST /systems/actuation/mode",
    b"POST /nodes/drive_base/state",
    b"PATCH /nodes/drive_base/parameters",
    b"POST /tasks",
    b"POST /tasks/preview",
    b"POST /model/check",
    b"POST /inference",
    b"POST /simulations",
)
_SIZES = st.sampled_from([1, 20, 1_000, 1_001, 30_000])
_BODIES = st.one_of(
    _SIZES.map(lambda n: b"[" * n),
    _SIZES.map(lambda n: b'{"a": ' * n),
    _SIZES.map(lambda n: b"{" + b", ".join(b'"k%d": 1' % k for k in range(n)) + b"}"),
    _SIZES.map(lambda n: b"[" + b"1, " * n + b"1]"),
    _SIZES.map(lambda n: b"[" + b"{}, " * n + b"{}]"),
    _SIZES.map(lambda n: b'{"engaged": true, ' * 1 + b'"reason": "' + b"a" * n + b'"}'),
    _SIZES.map(lambda n: b'{"value": ' + b"9" * n + b"}"),
    _SIZES.map(lambda n: b"{" + b'"engaged": true, ' * n + b'"engaged": false}'),
    _SIZES.map(lambda n: b'{"reason": "' + b"\\u0000" * n + b'"}'),
    _SIZES.map(lambda n: b"".join(b"%d,0,0\n" % k for k in range(n))),
    st.sampled_from(
        [b"\xff\xfe", b'{"value": NaN}', b'{"engaged": true}', b'{"from": "live"}', b""]
    ),
    st.binary(max_size=100),
)
_REQUEST = st.builds(
    lambda route, body, key: (
        route + b" HTTP/1.1\r\n" + HOST + key + b"Content-Length: %d\r\n\r\n" % len(body) + body
    ),
    st.sampled_from(_ROUTES),
    _BODIES,
    st.sampled_from([_KEY, _KEY, b""]),
)
BODIES = repeated(_REQUEST, 40).map(lambda data: [data])

STREAMS = st.one_of(SOCKETS, HEADS, BODIES)


def cut(data: bytes, sizes: list[int]) -> Iterator[bytes]:
    """Yield data in pieces of these sizes, again and again."""
    at = 0
    for size in cycle(sizes):
        if at >= len(data):
            return
        yield data[at : at + size]
        at += size
