"""The stream `WS /ws`; the route itself is in `api/streaming/route.py`."""
