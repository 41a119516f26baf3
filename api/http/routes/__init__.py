"""The resources of the HTTP API: one module for each, named as its path is.

A route parses, calls `service`, and shows the answer; it holds no rule of its own.
"""
