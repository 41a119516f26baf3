"""Loads numpy in a running service, before a request first needs it."""

from domain.arrays import is_numpy_loaded, load_numpy
from service.call_thread import CallThread


async def numpy_loaded() -> None:
    """Wait until numpy is loaded; at once if it is.

    It takes 0.1 s, and is done in a thread, which holds up the loop for some 10 ms. Whoever makes
    a path of what a client sent awaits this first; whatever else uses numpy has a path.
    """
    if is_numpy_loaded():
        return
    thread = CallThread("numpy")
    try:
        await thread.run(load_numpy)
    finally:
        thread.end()
