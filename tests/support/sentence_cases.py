"""What page and terminal say of the state of the robot: cases that both are tried with."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import product
from typing import Any, Literal

from api.cli.error_lines import error_name
from api.cli.monitor.store import Json
from tests.support import monitor as told

ABORTED = "task t1 was aborted at {ended}: left the path"


@dataclass(frozen=True, slots=True)
class Case:
    """A state of the robot, as members of a frame, and what is said of it."""

    name: str
    word: str
    level: Literal["calm", "held", "aborted", "attention", "error"]
    text: str
    more: tuple[str, ...] = ()
    members: Json = field(default_factory=dict)


def members(
    state: Json | None = None,
    task: Json | None = None,
    holds: tuple[Json, ...] = (),
    parts: tuple[Json, ...] = (),
    stop: Json | None = None,
    vehicle: Json | None = None,
    devices: tuple[Json, ...] = (),
    errors: tuple[Json, ...] = (),
) -> dict[str, Any]:
    """Return the members of a complete frame."""
    return {
        "system_state": state or told.system_state(),
        "task": task,
        "holds": told.named("owner", *holds),
        "parts": told.named("name", *parts),
        "signals": {},
        "emergency_stop": stop or told.stop(),
        "vehicle": vehicle or moving(0.0),
        "devices": told.named("device", *devices),
        "errors": {error_name(error): error for error in errors},
    }


def moving(speed_mps: float | None, **more: object) -> Json:
    """Return a vehicle of that speed; None: it never reported."""
    return {"speed_mps": speed_mps, "pose": None, "at": told.AT, **more}


def running() -> Json:
    """Return the system state of a robot with a task that is driven."""
    return told.system_state("RUNNING", task_status="RUNNING_TASK")


def paused() -> Json:
    """Return the system state of a robot with a task that is held; it counts as running."""
    return told.system_state("RUNNING", task_status="PAUSED_TASK")


def reason(code: str, message: str, state: str = "ERROR") -> Json:
    """Return a system state with one reason."""
    return {**told.system_state(state), "reasons": [{"code": code, "message": message}]}


GATE = told.hold("gate", "the gate is shut", by="anna")
LOW = told.system_state("ERROR", "battery 10 % is below 50 %")
PRESSED = told.system_state("ERROR", "emergency stop is engaged")
DEAD = told.off_target("manipulator", reachable=False)
OFF = told.off_target("drive_base")
SYSTEM = told.system(
    "actuation",
    "drive_base",
    "manipulator",
    state="inactive",
    converged=False,
    target={"state": "active", "mode": "FAST"},
)
OFF_TEXT = "drive_base is inactive, target active.FAST"

CASES = (
    Case("idle", "IDLE", "calm", "no task", members=members()),
    Case(
        "a task that drives",
        "RUNNING",
        "calm",
        "task t1 42 %, waypoint 41 of 66",
        members=members(running(), told.task(), vehicle=moving(2.8)),
    ),
    Case(
        "three holds",
        "HELD",
        "held",
        "task t1 at 42 %, held by gate (the gate is shut), operator and loading",
        members=members(
            paused(), told.task("PAUSED"), (GATE, told.hold("operator"), told.hold("loading"))
        ),
    ),
    Case(
        "a lost device stands for its parts",
        "IDLE",
        "attention",
        "device arm is lost; no task",
        ("drive_base is inactive, target active.FAST",),
        members=members(
            parts=(SYSTEM, OFF, {**DEAD, "device": "arm"}),
            devices=(told.device("arm", "lost"), told.device("base", "late")),
        ),
    ),
    Case(
        "a task over a restart",
        "HELD",
        "held",
        "task t1 at 42 %, held by restart and gate (the gate is shut)",
        members=members(
            paused(),
            told.task("PAUSED"),
            (told.hold("restart", "the task goes on when the hold restart is released"), GATE),
        ),
    ),
    Case(
        "five holds",
        "HELD",
        "held",
        "task t1 at 42 %, held by a, b, c and 2 more",
        members=members(paused(), told.task("PAUSED"), tuple(told.hold(name) for name in "abcde")),
    ),
    Case(
        "a held task that still rolls",
        "STOPPING",
        "calm",
        "task t1 at 42 %, held by gate (the gate is shut), still at 1.5 m/s",
        members=members(paused(), told.task("PAUSING"), (GATE,), vehicle=moving(1.5)),
    ),
    Case(
        "a paused task whose vehicle is pushed",
        "HELD",
        "attention",
        "the vehicle moves at 0.40 m/s; task t1 at 42 %, held by gate (the gate is shut)",
        members=members(paused(), told.task("PAUSED"), (GATE,), vehicle=moving(-0.4)),
    ),
    Case(
        "no pose",
        "HELD",
        "attention",
        "task t1 at 42 %, held by vehicle (no pose of the vehicle for 0.3 s)",
        members=members(
            paused(),
            told.task("PAUSED"),
            (told.hold("vehicle", "no pose of the vehicle for 0.3 s"),),
            vehicle=moving(2.0),
        ),
    ),
    Case(
        "a vehicle that cannot be commanded",
        "IDLE",
        "attention",
        "no task; a new one would be held by drive_process (the drive process has ended)",
        members=members(holds=(told.hold("drive_process", "the drive process has ended"),)),
    ),
    Case(
        "a controller that does not give a goal up",
        "IDLE",
        "attention",
        "no task; a new one would be held by navigation (the controller is gone)",
        members=members(holds=(told.hold("navigation", "the controller is gone"),)),
    ),
    Case(
        "a hold without a task",
        "IDLE",
        "calm",
        "no task; a new one would be held by gate (the gate is shut)",
        members=members(holds=(GATE,)),
    ),
    Case(
        "a dead node whose change failed",
        "IDLE",
        "attention",
        "manipulator is unreachable; no task",
        members=members(parts=(SYSTEM, told.part("drive_base"), DEAD)),
    ),
    Case(
        "a node off its target after a failed change",
        "IDLE",
        "attention",
        f"{OFF_TEXT}; no task",
        members=members(parts=(SYSTEM, OFF, told.part("manipulator"))),
    ),
    Case(
        "a part that is being changed",
        "IDLE",
        "calm",
        "no task",
        members=members(parts=(told.off_target("drive_base", change="c1"),)),
    ),
    Case(
        "a system that deviates by itself, with a reason",
        "IDLE",
        "attention",
        "actuation: nothing fits; no task",
        members=members(
            parts=(
                {**SYSTEM, "deviation_reason": "actuation: nothing fits"},
                told.part("drive_base"),
                told.part("manipulator"),
            )
        ),
    ),
    Case(
        "many nodes off their target",
        "IDLE",
        "attention",
        "n0 is unreachable; no task",
        ("n1 is unreachable", "n2 is unreachable", "7 more such parts"),
        members=members(parts=tuple(told.part(f"n{n}", reachable=False) for n in range(10))),
    ),
    Case(
        "one node more off its target than are named",
        "IDLE",
        "attention",
        "n0 is unreachable; no task",
        ("n1 is unreachable", "n2 is unreachable", "1 more such part"),
        members=members(parts=tuple(told.part(f"n{n}", reachable=False) for n in range(4))),
    ),
    Case(
        "a node in errorprocessing",
        "IDLE",
        "attention",
        "lidar is in errorprocessing; no task",
        members=members(parts=(told.part("lidar", "errorprocessing"),)),
    ),
    Case(
        "a node in a state that nobody knows",
        "IDLE",
        "attention",
        "lidar is in an unknown state, target active.FAST; no task",
        members=members(
            parts=({**told.off_target("lidar"), "actual": told.part("lidar", "unknown")["actual"]},)
        ),
    ),
    Case(
        "an urgent error while all parts are as they should be",
        "IDLE",
        "attention",
        "SCAN_SLOW: it is so; no task",
        members=members(
            errors=(
                told.error("SCAN_SLOW"),
                {**told.error("WARM"), "severity": "warning"},
                {**told.error("SHELVED"), "shelved_until_at": told.AT},
                {**told.error("FOLLOWS"), "root_cause": False},
                told.error("GONE", state="returned"),
            )
        ),
    ),
    Case(
        "more urgent errors than are named",
        "RUNNING",
        "attention",
        "camera.E0: it is so; task t1 42 %, waypoint 41 of 66",
        ("camera.E1: it is so", "camera.E2: it is so", "1 more such error"),
        members=members(
            running(),
            told.task(),
            vehicle=moving(2.8),
            errors=tuple(told.error(f"E{n}", "camera") for n in range(4)),
        ),
    ),
    Case(
        "an urgent error of a part that is told already",
        "IDLE",
        "attention",
        "manipulator is unreachable; no task",
        members=members(parts=(DEAD,), errors=(told.error("UNREACHABLE", "manipulator"),)),
    ),
    Case(
        "a driven task beside a dead node",
        "RUNNING",
        "attention",
        "manipulator is unreachable; task t1 42 %, waypoint 41 of 66",
        members=members(running(), told.task(), parts=(DEAD,), vehicle=moving(2.8)),
    ),
    Case(
        "after an aborted task",
        "ABORTED",
        "aborted",
        ABORTED,
        members=members(
            task=told.task("ABORTED", reason="left the path", ended_at=told.AT),
        ),
    ),
    Case(
        "after a task that succeeded",
        "IDLE",
        "calm",
        "no task",
        members=members(task=told.task("SUCCEEDED", ended_at=told.AT)),
    ),
    Case(
        "a canceled task of a vehicle that still rolls",
        "IDLE",
        "attention",
        "the vehicle moves at 2.0 m/s; no task",
        members=members(task=told.task("CANCELED", ended_at=told.AT), vehicle=moving(2.0)),
    ),
    Case(
        "an error with a task and another hold",
        "ERROR",
        "error",
        "battery 10 % is below 50 %, task t1 is paused",
        ("also held by gate (the gate is shut)",),
        members=members(LOW, told.task("PAUSED"), (told.hold("error"), GATE)),
    ),
    Case(
        "an error while the vehicle brakes",
        "ERROR",
        "error",
        "emergency stop is engaged, task t1 is stopping",
        ("the vehicle moves at 1.1 m/s",),
        members=members(
            PRESSED,
            told.task("PAUSING"),
            (told.hold("error"),),
            stop=told.stop(engaged=True),
            vehicle=moving(1.1),
        ),
    ),
    Case(
        "an error and a dead node",
        "ERROR",
        "error",
        "battery 10 % is below 50 %",
        ("manipulator is unreachable",),
        members=members(LOW, parts=(DEAD,)),
    ),
    Case(
        "a vehicle that should stand and does not",
        "STILL MOVING",
        "error",
        "still moving at 1.1 m/s, 34 s after the stop",
        members=members(
            reason("STILL_MOVING", "still moving at 1.1 m/s, 34 s after the stop"),
            vehicle=moving(1.1),
        ),
    ),
    Case(
        "a held vehicle that rolls on",
        "STILL MOVING",
        "error",
        "still moving at 0.5 m/s; no task",
        members=members(
            reason("STILL_MOVING", "still moving at 0.5 m/s", "IDLE"), vehicle=moving(0.5)
        ),
    ),
    Case(
        "a stop of a vehicle without a pose",
        "STANDSTILL UNKNOWN",
        "error",
        "no pose since the stop",
        members=members(reason("STANDSTILL_UNKNOWN", "no pose since the stop")),
    ),
    Case(
        "a task that no frame has told yet",
        "RUNNING",
        "calm",
        "the task is running",
        members=members(running(), vehicle=moving(0.0)),
    ),
    Case(
        "a held task that no frame has told yet",
        "PAUSED",
        "calm",
        "the task is paused",
        members=members(paused()),
    ),
)

FULL: Json = {**told.system_state(), "storage_fault": "the disk is full"}
STORAGE: tuple[tuple[Json, Literal["live", "lost"], tuple[str, str] | None], ...] = (
    (told.system_state(), "live", None),
    (told.system_state(), "lost", None),
    (FULL, "live", ("STORAGE FAILS", "the disk is full; a restart may forget what you ask now")),
    (FULL, "lost", ("STORAGE FAILED", "the disk is full")),
)
"""System state, contact, and what is said of storage: a word and a text."""


def combinations() -> Iterator[dict[str, Any]]:
    """Yield the members of a frame for each combination of what a robot can be in."""
    tasks = (
        None,
        told.task("RUNNING"),
        told.task("PAUSING"),
        told.task("PAUSED"),
        told.task("ABORTED", reason="left the path", ended_at=told.AT),
        told.task("SUCCEEDED", ended_at=told.AT),
    )
    holds: tuple[tuple[Json, ...], ...] = (
        (),
        (GATE,),
        (told.hold("vehicle", "no pose"),),
        (told.hold("drive_process", "it has ended"),),
        (told.hold("error", "low"), GATE, told.hold("b"), told.hold("c")),
    )
    errors = (None, LOW, reason("STILL_MOVING", "still moving"))
    parts: tuple[tuple[Json, ...], ...] = (
        (),
        (SYSTEM, OFF, told.part("manipulator")),
        (SYSTEM, OFF, DEAD),
        (told.off_target("drive_base", change="c1"),),
    )
    stops = (None, told.stop(engaged=True), told.stop(engaged=True, standstill_at=told.AT))
    speeds = (None, 0.0, 0.049, 2.0, -0.4)
    for task, held, error, part, stop, speed in product(tasks, holds, errors, parts, stops, speeds):
        current = task is not None and not task["ended_at"]
        status = "NO_TASK" if not current else "PAUSED_TASK" if held else "RUNNING_TASK"
        state = error or told.system_state("RUNNING" if current else "IDLE", task_status=status)
        yield members(state, task, held, part, stop, moving(speed))
