"""Path trackers: steering that follows a path. Read `tracker.py` first, then any tracker."""
