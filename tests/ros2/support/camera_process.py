"""Lets a camera publish in a process of its own."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

SCRIPT = Path(__file__).with_name("camera.py")


@contextmanager
def camera(rate_hz: float, size: int) -> Iterator[None]:
    """Publish images as long as the context lasts.

    Args:
        rate_hz: Images per second.
        size: Of each image, in bytes.
    """
    command = [sys.executable, str(SCRIPT), str(rate_hz), str(size)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        yield
    finally:
        process.kill()
        process.communicate()
