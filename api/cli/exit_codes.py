"""The exit codes, which mean the same for every command."""

MISUSED = 64
"""The command line cannot be read; EX_USAGE of sysexits.h. Nothing was done."""
INTERRUPTED = 130
"""Ended by Ctrl-C: 128 and the number of SIGINT, as shells have it."""

TABLE = """\
exit codes, the same for every command:
  0    done, or it is so
  1    rejected or failed, or it is not so
  2    not known: no answer, no outcome in time, or what it needs is missing,
       such as a file
  64   the command line is invalid; nothing was done
  130  ended by Ctrl-C
"""
