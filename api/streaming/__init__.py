"""What `WS /ws` sends and takes; the route itself is in `api/streaming/route.py`."""
