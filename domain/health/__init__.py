"""Health: signals, for how long they have been bad or silent, and which errors follow.

Read `signals.py` for the table, then `state_manager.py`. The emergency stop is here too.
"""
