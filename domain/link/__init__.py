"""Several computers of one robot: what they say to each other, and what follows from it.

Deterministic, without I/O: `service.link` carries the messages.
"""
