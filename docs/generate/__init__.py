"""Pages of `docs/reference` that follow from the code; `python -m docs.generate` renews them.

Read `pages.py` first. What only people can say (when an event happens, what a code means) stands
here beside a scan of the source, and a page is refused while the two disagree.
"""
