"""Whose word counts at a device, as clients see it."""

from dataclasses import dataclass
from enum import StrEnum

from domain.computers import ComputerName, DeviceState
from domain.timebase import Instant


class Word(StrEnum):
    """Whose word counts at a device."""

    NOBODY = "nobody"
    """It was never connected since its start: its nodes stay as they are."""
    SUPERVISOR = "supervisor"
    CUT_OFF = "cut_off"
    """It is cut off, and waits until it may act alone."""
    DEVICE = "device"
    """It is cut off, and acts alone."""


@dataclass(frozen=True, slots=True)
class LeadView:
    """A device, and whom it follows."""

    device: ComputerName
    word: Word
    supervisor: DeviceState
    """How the connection to the supervisor is."""
    since: Instant
    """Since when it is so."""
    reason: str
    """Why it is not connected, in words; empty: it is."""
    offline: str
    """What it does when it is cut off, in words."""
