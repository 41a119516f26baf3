"""How many connections a process may have."""

import resource


def allow_many_files() -> None:
    """Raise the soft limit to the hard one; processes that are started from here inherit it."""
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
