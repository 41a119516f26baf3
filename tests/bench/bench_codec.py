"""How long the event loop takes to write down one input or event, and how long to read it."""

import timeit
from time import thread_time
from typing import Any

import numpy as np
import pytest

from domain.actor import Actor
from domain.commands import Drive
from domain.events.event import RecordedEvent
from domain.events.parts import PartActualChanged
from domain.inputs import NodeReport, Reading, Readings, TaskRequest, VehicleReport
from domain.lifecycle import LifecycleState
from domain.outbox import Outputs
from domain.paths.path import Path
from domain.state_and_mode import ModeName, PartName, StateAndMode
from domain.vehicle import DriveCommand, Pose, VehicleState
from service.codec.codec import EVENTS, INPUTS, STEPS, Codec
from service.codec.recorded_step import recorded_step
from tests.support.bench import report

VEHICLE = VehicleReport(VehicleState(Pose(1.2345678, 2.3456789, 0.1234567), 1.23456, 0.0123))
ROUNDS = 20_000
ASKED_US = 10.0
AT = 1_764_420_000_123_456_789
WAYPOINTS = 100_000

ACTIVE = StateAndMode(LifecycleState.ACTIVE, ModeName("FAST"))
INACTIVE = StateAndMode(LifecycleState.INACTIVE)
RECORDS: dict[str, tuple[Codec[Any], object]] = {
    "readings of one signal": (
        INPUTS,
        Readings((Reading("battery_level", 0.5312345, AT),), "ros", Actor("ros", "ros")),
    ),
    "report of the vehicle": (INPUTS, VEHICLE),
    "report of a node": (
        INPUTS,
        NodeReport(PartName("planner"), LifecycleState.ACTIVE, ModeName("FAST"), {"speed": 0.5}),
    ),
    "event": (
        EVENTS,
        RecordedEvent(
            12_345, AT, 12_344, Actor(), PartActualChanged(PartName("arm"), ACTIVE, INACTIVE, None)
        ),
    ),
    "step: report and drive command": (
        STEPS,
        recorded_step(
            AT,
            VEHICLE,
            False,
            Outputs((Drive(DriveCommand(1.2345, 0.0123)),), vehicle_changed=True),
        ),
    ),
}


@pytest.mark.bench
def test_records() -> None:
    rows = {name: _measure(codec, value, ROUNDS) for name, (codec, value) in RECORDS.items()}
    places = np.arange(3.0 * WAYPOINTS).reshape(-1, 3)
    task = TaskRequest(Path(places), 1, "stanley", 1.0)
    rows[f"task of {WAYPOINTS:,} waypoints"] = _measure(INPUTS, task, 3)
    report(
        "codec",
        "Records of the core",
        "Each value is written as JSON and read back in process; processor time of the best of "
        "five runs.",
        rows,
        asked=f"at most {ASKED_US:g} us to write a usual input or an event.",
    )


def _measure(codec: Codec[Any], value: object, rounds: int) -> dict[str, float]:
    text = codec.encode(value)
    write = timeit.repeat(lambda: codec.encode(value), timer=thread_time, number=rounds, repeat=5)
    read = timeit.repeat(lambda: codec.decode(text), timer=thread_time, number=rounds, repeat=5)
    return {
        "bytes": len(text),
        "write_us": round(min(write) / rounds * 1e6, 2),
        "read_us": round(min(read) / rounds * 1e6, 2),
    }
