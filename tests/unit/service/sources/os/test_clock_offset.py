"""The offset of the clock, as chronyc or the kernel tells it."""

import ctypes
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from service.sources.os import clock_offset
from service.sources.os.clock_offset import (
    STA_NANO,
    STA_UNSYNC,
    Timex,
    clock_offset_s,
    offset_in,
)
from service.sources.source import SourceError

TRACKING = (
    "C0A80001,192.168.0.1,3,1764420000.123456789,{offset},0.000001,0.000002,"
    "-1.5,0.01,0.02,0.03,0.04,64.2,{leap}\n"
)


@pytest.fixture
def chronyc(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Return what installs a `chronyc` that is a script."""

    def install(script: str) -> None:
        program = tmp_path / "chronyc"
        program.write_text(f"#!/bin/sh\n{script}\n")
        program.chmod(0o755)
        monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")

    return install


def told(offset: str, leap: str = "Normal") -> str:
    return f"printf '%s' '{TRACKING.format(offset=offset, leap=leap)}'"


@pytest.mark.parametrize(("offset", "seconds"), [("0.000250000", 0.00025), ("-13.000000000", 13.0)])
def test_chrony_tells_the_measured_offset(
    chronyc: Callable[[str], None], offset: str, seconds: float
) -> None:
    chronyc(told(offset))

    assert clock_offset_s() == seconds


@pytest.mark.parametrize(
    ("script", "why"),
    [
        (told("0.0", "Not synchronised"), "not synchronised"),
        ("echo '506 Cannot talk to daemon'; exit 1", "506 Cannot talk to daemon"),
        ("echo strange", "strange"),
    ],
)
def test_without_a_measurement_there_is_no_offset(
    chronyc: Callable[[str], None], script: str, why: str
) -> None:
    chronyc(script)

    with pytest.raises(SourceError, match=why):
        clock_offset_s()


def test_a_chronyc_that_hangs_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    def hang(*_: object, **settings: float) -> None:
        raise subprocess.TimeoutExpired("chronyc", settings["timeout"])

    monkeypatch.setattr("shutil.which", lambda _: "/usr/bin/chronyc")
    monkeypatch.setattr("subprocess.run", hang)
    with pytest.raises(SourceError, match="chronyc does not answer"):
        clock_offset_s()


@pytest.mark.parametrize(
    ("offset", "status", "seconds"),
    [(-2_500, 0, 0.0025), (2_500_000, STA_NANO, 0.0025)],
)
def test_without_chrony_the_kernel_tells_what_it_still_corrects(
    monkeypatch: pytest.MonkeyPatch, offset: int, status: int, seconds: float
) -> None:
    monkeypatch.setattr("shutil.which", lambda _: None)

    def adjtimex(reference: Any) -> int:  # noqa: ANN401  # of ctypes
        timex = ctypes.cast(reference, ctypes.POINTER(Timex)).contents
        timex.offset, timex.status = offset, status
        return 0

    monkeypatch.setattr(clock_offset, "_adjtimex", lambda: adjtimex)
    assert clock_offset_s() == pytest.approx(seconds)


def test_a_clock_that_nothing_synchronises_has_no_offset() -> None:
    timex = Timex()
    timex.status = STA_UNSYNC

    with pytest.raises(SourceError, match="not synchronised"):
        offset_in(timex)


def test_a_kernel_that_does_not_tell_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda _: None)

    def refuse(_: object) -> int:
        ctypes.set_errno(1)
        return -1

    monkeypatch.setattr(clock_offset, "_adjtimex", lambda: refuse)
    with pytest.raises(PermissionError, match="adjtimex"):
        clock_offset_s()
