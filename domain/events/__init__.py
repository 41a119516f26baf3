"""What happened, as values: one small class per kind of event.

Read `event.py` first. To add a kind, add a class to the module of its subject, with its words, and
emit it: the stream, the log, the page and the reference of events follow.
"""
