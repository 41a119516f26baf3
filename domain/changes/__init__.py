"""Changes of state, mode and parameters: the meaning of a request, its admission, its steps.

Read `changes.py` first, then `node_steps.py`.
"""
