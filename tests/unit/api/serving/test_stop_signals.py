import asyncio
import os
import signal
from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from api.serving.stop_signals import StopSignals

ANY = st.sampled_from(["SIGHUP", "SIGINT", "SIGTERM", "SIGQUIT", "SIGUSR1", "SIGXCPU"])


class EndedError(Exception):
    """The process ended at once."""


class Service:
    def __init__(self) -> None:
        self.now = 0.0
        self.stops = 0
        self.signals = StopSignals(self._stop)

    def take(self, name: str) -> None:
        self.signals.take(name, lambda: self.now)

    def _stop(self) -> None:
        self.stops += 1


@pytest.fixture(autouse=True)
def _no_real_end(monkeypatch: pytest.MonkeyPatch) -> None:
    def end(code: int) -> None:
        raise EndedError(code)

    monkeypatch.setattr(os, "_exit", end)


@pytest.fixture
def hangup() -> Iterator[None]:
    before = signal.getsignal(signal.SIGHUP)
    yield
    signal.signal(signal.SIGHUP, before)


def test_a_second_ctrl_c_ends_it_at_once() -> None:
    service = Service()
    service.take("SIGTERM")
    service.now = 0.2

    with pytest.raises(EndedError, match="130"):
        service.take("SIGINT")


def test_a_ctrl_c_that_a_wrapper_passes_on_is_the_same_one() -> None:
    service = Service()
    service.take("SIGINT")
    service.now = 0.05
    service.take("SIGINT")

    assert service.stops == 1


def test_a_session_that_closes_hangs_up_twice_and_the_vehicle_is_stopped_nevertheless() -> None:
    service = Service()
    service.take("SIGHUP")
    service.now = 3.0
    service.take("SIGHUP")

    assert service.stops == 1


@given(st.lists(st.tuples(ANY, st.floats(0.0, 2.0)), min_size=1, max_size=8))
def test_whatever_comes_the_vehicle_is_stopped_once_and_before_the_end(
    signals: list[tuple[str, float]],
) -> None:
    service = Service()
    for name, after_s in signals:
        service.now += after_s
        try:
            service.take(name)
        except EndedError:
            break

    assert service.stops == 1


@pytest.mark.usefixtures("hangup")
async def test_a_hangup_that_nohup_ignores_stays_ignored() -> None:
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    service = Service()
    service.signals.install()

    assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    _uninstall()


@pytest.mark.usefixtures("hangup")
async def test_a_hangup_stops_the_service() -> None:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    service = Service()
    service.signals.install()
    os.kill(os.getpid(), signal.SIGHUP)
    await asyncio.sleep(0.05)

    assert service.stops == 1
    _uninstall()


def _uninstall() -> None:
    for number in signal.valid_signals() - {signal.SIGKILL, signal.SIGSTOP}:
        asyncio.get_running_loop().remove_signal_handler(number)
