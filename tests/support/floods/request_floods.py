"""Floods of whole requests, each as expensive as one can be."""

import json
from types import MappingProxyType

from tests.support.floods.flood import HOST, Flood, websocket_handshake


def _request(method: str, path: str, body: bytes = b"") -> bytes:
    length = f"Content-Length: {len(body)}\r\n\r\n".encode()
    return f"{method} {path} HTTP/1.1\r\n".encode() + HOST + length + body


def _members(count: int) -> bytes:
    return json.dumps({f"k{number}": 1 for number in range(count)}).encode()


_LIVE = b'{"from": "live", "until_s": 0}'

REQUEST_FLOODS = MappingProxyType(
    {
        "a path of 60,000 bytes": Flood(14, again=_request("GET", "/nodes/" + "a/" * 30_000)),
        "a path of 30,000 bytes": Flood(14, again=_request("GET", "/nodes/" + "a/" * 15_000)),
        "a path of 4,000 bytes": Flood(14, again=_request("GET", "/nodes/" + "a/" * 1_990)),
        "a query of 8,000 bytes": Flood(14, again=_request("GET", "/events?" + "a&" * 3_990)),
        "a body of 24,000 members": Flood(
            4, again=_request("PATCH", "/mock/temperature", _members(24_000))
        ),
        "a body of 1,000 members": Flood(
            4, again=_request("PATCH", "/mock/temperature", _members(1_000))
        ),
        "/openapi.json": Flood(4, again=_request("GET", "/openapi.json")),
        "/metrics": Flood(4, again=_request("GET", "/metrics")),
        "/events?limit=1000": Flood(4, again=_request("GET", "/events?limit=1000")),
        "copies of the live robot": Flood(20, again=_request("POST", "/simulations", _LIVE)),
        "holds of 50 clients": Flood(
            50, again=_request("PUT", "/holds/flood") + _request("DELETE", "/holds/flood")
        ),
        "readings of 50 clients": Flood(
            50, again=2 * _request("POST", "/signals", b'{"battery_level": 0.9}')
        ),
        "200 clients that resume": Flood(200, websocket_handshake("/ws?after=0"), lasts_s=0.5),
        "200 clients that resume, each elsewhere": Flood(
            200, websocket_handshake("/ws?after=NUMBER"), lasts_s=0.5
        ),
    }
)
