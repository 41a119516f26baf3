import sys
from types import SimpleNamespace

import pytest

from service.files.source_block import SystemdBlock
from service.sources.source import SourceError, reason_of
from service.sources.systemd import systemd_source
from tests.support.manual_clock import ManualClock

BUS = "service.sources.systemd_bus"
UNIT = "camera.service"


def manager(states: tuple[str, str], restarts: int = 0) -> SimpleNamespace:
    made = SimpleNamespace(states=lambda _: states, restarts=lambda _: restarts, close=lambda: None)
    return SimpleNamespace(ServiceManager=lambda _: made)


def read(block: SystemdBlock) -> object:
    (probe,) = systemd_source(ManualClock(), "system", {"camera": block}).probes
    return probe.read()


@pytest.mark.parametrize(
    ("state", "active", "failed"),
    [
        ("active", 1, 0),
        ("reloading", 1, 0),
        ("activating", 0, 0),
        ("deactivating", 0, 0),
        ("inactive", 0, 0),
        ("failed", 0, 1),
    ],
)
def test_a_unit_is_active_or_not(
    monkeypatch: pytest.MonkeyPatch, state: str, active: int, failed: int
) -> None:
    monkeypatch.setitem(sys.modules, BUS, manager(("loaded", state)))

    assert read(SystemdBlock(unit=UNIT)) == active
    assert read(SystemdBlock(unit=UNIT, what="failed")) == failed


def test_restarts_are_counted_by_systemd(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, BUS, manager(("loaded", "active"), restarts=3))

    assert read(SystemdBlock(unit=UNIT, what="restarts")) == 3


def test_a_unit_that_does_not_exist_is_no_bad_value(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, BUS, manager(("not-found", "inactive")))

    with pytest.raises(SourceError, match=r"there is no unit camera\.service"):
        read(SystemdBlock(unit=UNIT))


def test_without_the_library_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, BUS, raising=False)
    monkeypatch.setitem(sys.modules, "sdbus", None)

    with pytest.raises(SourceError, match="sdbus") as caught:
        read(SystemdBlock(unit=UNIT))
    assert "pip install 'pilothouse[systemd]'" in reason_of(caught.value)
