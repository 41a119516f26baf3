"""The monitor page, as files: HTML, CSS, ES modules and SVG.

A Python package only so that `importlib.resources` finds the files in a source tree and in an
installed wheel alike. No build step and no third-party script: `api.http.page` bundles them at the
start. Read `index.html` first.
"""
