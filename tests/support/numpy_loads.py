"""Stands for the loading of numpy, which a process does once only."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from service import numpy_loading


class NumpyLoads:
    """numpy as a service finds it that has not used it yet."""

    def __init__(self) -> None:
        self.threads: list[threading.Thread] = []
        """In which it was loaded."""
        self.may_end = threading.Event()
        """Loading takes until this is set."""
        self.is_loaded = False

    def load(self) -> None:
        """Load it."""
        self.threads.append(threading.current_thread())
        self.may_end.wait()
        self.is_loaded = True


@contextmanager
def numpy_not_loaded() -> Iterator[NumpyLoads]:
    """Let the service take numpy for not loaded; loading it takes no time unless it is held up."""
    loads = NumpyLoads()
    loads.may_end.set()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(numpy_loading, "load_numpy", loads.load)
        patch.setattr(numpy_loading, "is_numpy_loaded", lambda: loads.is_loaded)
        yield loads
