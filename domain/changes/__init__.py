"""Changes of state, mode and parameters: what a request means, whether it may begin, and its steps.

Read `operations.py` first.
"""
