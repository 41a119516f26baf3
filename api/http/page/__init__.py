"""How the page reaches a browser: bundles of its modules and styles, by version, compressed."""
