"""`python -m api.http.page.make_ahead`: minify the page before the first start.

Whoever builds an image runs this, and then removes the library.
"""

import sys
from collections.abc import Mapping

from api.http.page.ahead import keep
from api.http.page.assembled_page import assemble, sources
from api.http.page.minifier import minified


def main() -> int:
    """Keep what the library makes of the page; return the exit code."""
    made = assemble(sources(), _shorten)
    print(f"the page {made.version} is minified")
    return 0


def _shorten(texts: Mapping[str, str]) -> Mapping[str, str]:
    made = minified(texts)
    if made == texts:
        sys.exit("the page was not minified: is tdewolff-minify installed?")
    keep(texts, made)
    return made


if __name__ == "__main__":
    sys.exit(main())
