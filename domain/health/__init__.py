"""Health: signals, how long they have been bad or stale, and the errors that follow.

Read `signals.py` for the table, then `state_manager.py`. The emergency stop is here too.
"""
