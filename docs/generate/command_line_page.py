"""The command line, from the output of `--help`."""

import contextlib
import io
import os
import re
from collections.abc import Callable
from importlib.metadata import entry_points
from unittest.mock import patch

from docs.generate.markdown import page

_COMMAND = re.compile(r"^    (\w+) {2,}\S", re.MULTILINE)
_WIDTH = "88"
"""Columns of the help; argparse subtracts two."""


def command_line_page() -> str:
    """Return the page `command-line.md`."""
    own = help_of()
    blocks = ["The command is `pilothouse`; in a checkout, `.venv/bin/pilothouse`.", _block(own)]
    for name in _COMMAND.findall(own):
        blocks += [f"## {name}", _block(help_of(name))]
    return page("Command line", *blocks)


def help_of(*command: str) -> str:
    """Return what `pilothouse COMMAND --help` prints, independent of the environment."""
    (script,) = entry_points(group="console_scripts", name="pilothouse")
    main: Callable[[list[str]], int] = script.load()
    printed = io.StringIO()
    kept = {name: value for name, value in os.environ.items() if "PILOTHOUSE" not in name}
    plain = {**kept, "COLUMNS": _WIDTH, "NO_COLOR": "1"}
    with (
        patch.dict(os.environ, plain, clear=True),
        contextlib.redirect_stdout(printed),
        contextlib.suppress(SystemExit),
    ):
        main([*command, "--help"])
    return printed.getvalue()


def _block(text: str) -> str:
    return f"```text\n{text.strip()}\n```"
