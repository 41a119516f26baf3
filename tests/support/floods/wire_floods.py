"""Floods below HTTP's meaning: frames, heads, bodies and connections."""

from types import MappingProxyType

from tests.support.floods.flood import HOST, Flood, websocket_handshake

_PIECE = 60_000


def _many(piece: bytes) -> bytes:
    return piece * (_PIECE // len(piece))


def _frames(path: str, frame: bytes, connections: int = 1) -> Flood:
    return Flood(connections, websocket_handshake(path), _many(frame))


_PING = b"\x89\x80\0\0\0\0"
_PONG = b"\x8a\x80\0\0\0\0"
_TEXT = b"\x81\x80\0\0\0\0"
_FRAGMENT = b"\x00\x80\0\0\0\0"
_CHUNKED = b"POST /models/validate HTTP/1.1\r\n" + HOST + b"Transfer-Encoding: chunked\r\n\r\n"
_GET = b"GET /x HTTP/1.1\r\n" + HOST + b"\r\n"

WIRE_FLOODS = MappingProxyType(
    {
        "empty pings": _frames("/ws", _PING),
        "empty pongs": _frames("/ws", _PONG),
        "empty texts": _frames("/ws", _TEXT),
        "empty fragments": _frames("/ws", _FRAGMENT),
        "empty pings, rosbridge": _frames("/rosbridge", _PING),
        "empty pings, 110 connections": _frames("/ws", _PING, 110),
        "pipelined GET, 20 connections": Flood(20, again=_many(_GET)),
        "pipelined GET, 110 connections": Flood(110, again=_many(_GET)),
        "pipelined GET, unread": Flood(20, again=_many(_GET), reads=False),
        "chunks of one byte": Flood(20, again=_CHUNKED + _many(b"1\r\na\r\n")),
        "trailers": Flood(20, again=_CHUNKED + b"0\r\n" + _many(b"a: b\r\n")),
        "heads without end": Flood(20, again=b"GET /x HTTP/1.1\r\n" + _many(b"a: b\r\n")),
        "slow heads": Flood(1_000, again=b"GET", every_s=0.5),
        "silent connections": Flood(3_000),
        "connections that come and go": Flood(50, again=b"\0", every_s=0.001),
        "/ws without a token": Flood(110, websocket_handshake("/ws")),
    }
)
