"""Completion by the shell, from the parser itself; argcomplete speaks with the shells."""

import argparse

import argcomplete
from argcomplete.shell_integration import shellcode


def script_for(shell: str) -> str:
    """Return the script that lets a shell complete `pilothouse`.

    Args:
        shell: `bash`, `zsh` or `fish`.
    """
    return str(shellcode(["pilothouse"], shell=shell))


def complete(parser: argparse.ArgumentParser) -> None:
    """Answer the shell what can follow on its command line, and end the process."""
    argcomplete.autocomplete(parser, always_complete_options=False)
