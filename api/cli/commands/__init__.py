"""The commands of `pilothouse`: options, help and implementation of each.

What a command works with is imported when it runs, so that `--help` is quick.
"""
