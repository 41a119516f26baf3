"""Events as values: one small class per kind.

Read `event.py` first. To add a kind, add a class with its words to the module of its subject, and
emit it: stream, log, page and the reference of events need no change.
"""
