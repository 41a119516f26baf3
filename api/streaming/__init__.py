"""What `WS /ws` sends and takes; the route itself is in `api/routes/stream.py`."""
