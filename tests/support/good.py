"""Readings of which none is an error."""

from collections.abc import Mapping

from domain.inputs import SignalValue

GOOD: Mapping[str, SignalValue] = {
    "battery_level": 1.0,
    "estop": False,
    "gps_accuracy": 100.0,
    "signal_strength": "CONNECTED",
    "temperature": 30.0,
}
