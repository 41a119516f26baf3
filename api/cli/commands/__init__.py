"""The commands of `pilothouse`: each with its options, its help and what it does.

What a command works with is imported when it runs, so that `--help` is quick.
"""
