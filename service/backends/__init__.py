"""Adapters of the port through which nodes are reached; each is independent of the others.

The port itself is in `service.ports`. An adapter whose library is optional imports that library
here and nowhere else.
"""
