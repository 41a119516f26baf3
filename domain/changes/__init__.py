"""Changes of state, mode and parameters: the meaning of a request, its admission, its steps.

Read `operations.py` first.
"""
