"""Generates the pages of `docs/reference`: `python -m docs.generate`.

Read `pages.py` first. What the code cannot say (when an event happens, what a code means) is
written here and checked against a scan of the source. If the two disagree, no page is generated.
"""
