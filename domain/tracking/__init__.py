"""Path trackers: where to steer to stay on a path. Read `tracker.py` first, then any of them."""
