"""How far the clock of this computer is from that of its time server.

What was measured, not what is asked for: a time service may call itself synchronised seconds before
it steps the clock.
"""

import ctypes
import os
import shutil
import subprocess
from collections.abc import Callable
from typing import Final

from service.sources.source import SourceError

_CHRONYC: Final = "chronyc"
_TIMEOUT_S: Final = 0.8
_OFFSET, _LEAP, _FIELDS = 4, 13, 14
"""Positions in `chronyc -c tracking`. Source: chrony, `client.c`, `process_cmd_tracking`."""
_NOT_SYNCHRONISED: Final = "the clock is not synchronised"


def clock_offset_s() -> float:
    """Return the magnitude of the offset, in seconds.

    Raises:
        SourceError: It is not known: no time service works, or it has not synchronised the clock.
    """
    if shutil.which(_CHRONYC) is not None:
        return _of_chrony()
    return _of_kernel()


def _of_chrony() -> float:
    try:
        done = subprocess.run(
            (_CHRONYC, "-n", "-c", "tracking"),
            capture_output=True,
            check=False,
            stdin=subprocess.DEVNULL,
            text=True,
            timeout=_TIMEOUT_S,
        )
    except subprocess.TimeoutExpired as error:
        raise SourceError("chronyc does not answer") from error
    fields = done.stdout.strip().split(",")
    if done.returncode != 0 or len(fields) < _FIELDS:
        raise SourceError(f"chronyc fails: {(done.stdout or done.stderr).strip()[:100]}")
    if fields[_LEAP] == "Not synchronised":
        raise SourceError(_NOT_SYNCHRONISED)
    return abs(float(fields[_OFFSET]))


class Timex(ctypes.Structure):
    """Source: Linux, adjtimex(2)."""

    _fields_ = (  # type: ignore[mutable-override]  # ctypes takes any sequence
        ("modes", ctypes.c_uint),
        ("offset", ctypes.c_long),
        ("freq", ctypes.c_long),
        ("maxerror", ctypes.c_long),
        ("esterror", ctypes.c_long),
        ("status", ctypes.c_int),
        ("further", ctypes.c_char * 256),
    )


STA_UNSYNC, STA_NANO = 0x0040, 0x2000


def _of_kernel() -> float:
    """Return the offset that the kernel still has to correct, as a time service told it."""
    timex = Timex()
    if _adjtimex()(ctypes.byref(timex)) < 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number), "adjtimex")
    return offset_in(timex)


def _adjtimex() -> Callable[[object], int]:
    try:
        found: Callable[[object], int] = ctypes.CDLL(None, use_errno=True).adjtimex
    except AttributeError as error:
        raise SourceError("this system does not tell how far its clock is off") from error
    return found


def offset_in(timex: Timex) -> float:
    """Return the magnitude of the offset that the kernel told, in seconds.

    Raises:
        SourceError: Nothing synchronises the clock.
    """
    if timex.status & STA_UNSYNC:
        raise SourceError(_NOT_SYNCHRONISED)
    unit = 1e-9 if timex.status & STA_NANO else 1e-6
    return abs(float(timex.offset)) * unit
