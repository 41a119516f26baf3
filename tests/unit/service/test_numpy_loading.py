import asyncio
import threading
from collections.abc import Iterator

import pytest

from service import numpy_loading
from service.numpy_loading import numpy_loaded
from tests.support.numpy_loads import NumpyLoads, numpy_not_loaded
from tests.support.waiting import until


@pytest.fixture
def numpy() -> Iterator[NumpyLoads]:
    """Takes long to load."""
    with numpy_not_loaded() as loads:
        loads.may_end.clear()
        yield loads


async def test_the_loop_goes_on_while_a_thread_loads_it_and_ends(numpy: NumpyLoads) -> None:
    loading = asyncio.create_task(numpy_loaded())
    await until(lambda: len(numpy.threads) == 1)
    assert not loading.done()

    numpy.may_end.set()
    await loading

    (thread,) = numpy.threads
    assert thread is not threading.current_thread()
    thread.join(10.0)
    assert not thread.is_alive()


async def test_whoever_comes_meanwhile_waits_too(numpy: NumpyLoads) -> None:
    both = [asyncio.create_task(numpy_loaded()) for _ in range(2)]
    await until(lambda: len(numpy.threads) == 2)
    assert not any(loading.done() for loading in both)

    numpy.may_end.set()
    await asyncio.gather(*both)


async def test_there_is_no_thread_once_it_is_loaded(numpy: NumpyLoads) -> None:
    numpy.is_loaded = True

    await numpy_loaded()

    assert numpy.threads == []


async def test_it_is_loaded_though_the_client_goes(numpy: NumpyLoads) -> None:
    loading = asyncio.create_task(numpy_loaded())
    await until(lambda: len(numpy.threads) == 1)
    loading.cancel()
    with pytest.raises(asyncio.CancelledError):
        await loading

    numpy.may_end.set()
    numpy.threads[0].join(10.0)

    assert numpy.is_loaded


async def test_what_keeps_it_from_being_loaded_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> None:
        raise ImportError("libblas.so: failed to map segment from shared object")

    monkeypatch.setattr(numpy_loading, "load_numpy", fail)
    monkeypatch.setattr(numpy_loading, "is_numpy_loaded", lambda: False)

    with pytest.raises(ImportError, match="map segment"):
        await numpy_loaded()
