"""Frames as the terminal monitor gets them, and views as it draws them."""

import io
from typing import Any

from rich.console import Console

from api.cli.monitor.store import Json, Robot, fold
from api.cli.monitor.view import Contact, Level, View, seconds_of

AT = "2026-05-04T12:00:00.000Z"
URL = "http://robot:8000"

LIVE = Contact(Level.LIVE, 0.0)


def after(seconds: float) -> str:
    """Return the time so many seconds after `AT`."""
    return f"2026-05-04T12:00:{seconds:06.3f}Z"


def part(name: str, state: str = "active", mode: str | None = None, **more: object) -> Json:
    """Return a node that is as it should be."""
    actual = {
        "state": state,
        "mode": mode,
        "inferred": False,
        "mode_inferred": False,
        "undecidable": False,
        "reason": None,
    }
    return {
        "name": name,
        "kind": "node",
        "parts": [],
        "target": None,
        "effective_target": None,
        "actual": actual,
        "converged": True,
        "deviation_since_at": None,
        "deviation_reason": None,
        "reachable": True,
        "change": None,
        **more,
    }


def system(name: str, *parts: str, state: str = "active", **more: object) -> Json:
    """Return a system of these parts, as it should be; its state is inferred."""
    found = part(name, state, None, kind="system", parts=list(parts), **more)
    return {**found, "actual": {**found["actual"], "inferred": True}}


def off_target(name: str, **more: object) -> Json:
    """Return a node that should be active and is inactive since `AT`."""
    target = {"state": "active", "mode": "FAST"}
    wrong: dict[str, Any] = {"converged": False, "deviation_since_at": AT, "target": target}
    return part(name, "inactive", None, **{**wrong, **more})


def signal(name: str, value: object = 1.0, unit: str = "", **more: object) -> Json:
    """Return a signal that is good and was received at `AT`."""
    return {
        "signal": name,
        "value": value,
        "unit": unit,
        "source": "mock",
        "received_at": AT,
        "stale": False,
        "error": None,
        "source_fault": None,
        "pending": None,
        **more,
    }


def error(name: str, part: str | None = None, state: str = "active") -> Json:
    """Return an error that was raised at `AT`."""
    return {
        "error": name,
        "part": part,
        "severity": "urgent",
        "state": state,
        "shelved_until_at": None,
        "suppressed": False,
        "root_cause": True,
        "message": "it is so",
        "since_at": AT,
    }


def device(name: str, state: str = "connected", **more: object) -> Json:
    """Return a device that was last heard at `AT`, and owns the node `drive_base`."""
    return {
        "device": name,
        "state": state,
        "reason": "",
        "since_at": AT,
        "heard_at": AT,
        "parts": ["drive_base"],
        "incarnation": "1" * 32,
        "session": "2" * 32,
        "autonomous": False,
        "offline": {"after_s": 2.0, "target": {"drive_base": "inactive"}, "reactions": False},
        "stops": [],
        "version": "0.1.0",
        "refused": "",
        **more,
    }


def this_device(name: str, lead: str = "supervisor", **more: object) -> Json:
    """Return what the service of a device tells of itself."""
    return {
        "device": name,
        "lead": lead,
        "supervisor": "connected" if lead == "supervisor" else "lost",
        "since_at": AT,
        "reason": "",
        "when_cut_off": "after 2 s: drive_base to inactive",
        **more,
    }


def task(status: str = "RUNNING", **more: object) -> Json:
    """Return a task in its middle."""
    return {
        "id": "t1",
        "status": status,
        "controller": "stanley",
        "speed_mps": 2.8,
        "waypoint_count": 66,
        "length_m": 800.0,
        "start_index": 0,
        "target_index": 40,
        "progress": 0.42,
        "distance_m": 336.0,
        "cross_track_error_m": 0.031,
        "reason": None,
        "created_at": AT,
        "ended_at": None,
        **more,
    }


def hold(owner: str, reason: str = "", by: str = "") -> Json:
    """Return a hold that was set at `AT`."""
    return {"owner": owner, "reason": reason, "by": by, "since_at": AT}


def stop(*, engaged: bool = False, **more: object) -> Json:
    """Return the emergency stop."""
    nothing = {"by": None, "reason": None, "since_at": None, "standstill_at": None}
    return {"engaged": engaged, **nothing, **more}


def system_state(state: str = "IDLE", *reasons: str, task_status: str = "NO_TASK") -> Json:
    """Return the system state with reasons in words, each the error E0, E1, ..."""
    return {
        "state": state,
        "errors": [f"E{number}" for number in range(len(reasons))],
        "reasons": [{"message": reason} for reason in reasons],
        "task_status": task_status,
        "simulated": [],
        "storage_fault": None,
    }


def frame(at: str = AT, **members: object) -> Json:
    """Return a `state` frame with these members, and the system state."""
    return {"type": "state", "seq": 1, "at": at, "system_state": system_state(), **members}


def graph(*parts: Json, settled: bool = True, at: str = AT) -> Json:
    """Return a frame of what was observed in a ROS 2 graph."""
    return {
        "type": "graph",
        "at": at,
        "model": "models/robot.yaml",
        "settled": settled,
        "parts": named("name", *parts),
    }


def named(key: str, *items: Json) -> dict[str, Json]:
    """Return items by what they have under a key."""
    return {item[key]: item for item in items}


def hello(
    epoch: str = "one",
    started_at: str = AT,
    *,
    boot: int = 1,
    newest: int = 0,
    model: str = "robot.yaml",
) -> Json:
    """Return the first frame of a connection."""
    return {
        "type": "hello",
        "model": model,
        "epoch": epoch,
        "boot": boot,
        "started_at": started_at,
        "newest": newest,
    }


def event(number: int, words: str = "something happened", *, notable: bool = True) -> Json:
    """Return an event that happened at `AT`."""
    about = {"kind": "test.happened", "actor": "", "data": {}}
    told = {"words": words, "notable": notable}
    return {"type": "event", "id": number, "at": AT, **about, **told}


def robot(*messages: Json, parts: tuple[Json, ...] = (), signals: tuple[Json, ...] = ()) -> Robot:
    """Return a robot of which everything is known, after these messages as well."""
    begin = (
        hello(),
        frame(
            parts=named("name", *parts),
            signals=named("signal", *signals),
            task=None,
            holds={},
            emergency_stop=stop(),
        ),
    )
    known = Robot()
    for message in (*begin, *messages):
        known = fold(known, message)
    return known


def view(known: Robot, contact: Contact = LIVE, later_s: float = 0.0) -> View:
    """Return what is to be drawn so many seconds after `AT`."""
    return View(URL, known, contact, seconds_of(AT) + later_s)


def console(width: int = 80, height: int = 24) -> Console:
    """Return a console of this size that writes to a string, without colours."""
    return Console(file=io.StringIO(), width=width, height=height, highlight=False)
