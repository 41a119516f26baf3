"""The resources of the HTTP API: one module for each, named as its path is.

A route parses a request, calls `service`, and encodes the answer; it contains no rules.
"""
