"""The requests that the OpenAPI document shows: a day of the example robot, in virtual time."""

from dataclasses import dataclass, field
from typing import Any

from domain.health.checkpoints import CheckpointSettings
from domain.state_and_mode import PartName
from tests.support.http_robot import ACTUATION

REACTING = ACTUATION.replace(
    "drive_base:\n",
    """\
    errors:
      BLOCKED: {severity: urgent, hint: clear the way}
    reactions:
      COOL_DOWN: {when: "temperature > 50", action: mode, target: active.MODERATE}
drive_base:
""",
    1,
).replace(
    "manipulator:\n",
    """\
    errors:
      OVERCURRENT: {severity: urgent, hint: look for what blocks the wheels}
    reactions:
      RESTART_BASE: {when: "drive_base.errors.ERROR_PROCESSING", for_s: 1, action: restart}
manipulator:
""",
    1,
)
"""The robot of D4.8, Annex 4, with a reaction of a system and one of a node."""

JSON = "application/json"
YAML = "application/yaml"
CSV = "text/csv"


@dataclass(frozen=True, slots=True)
class Asked:
    """One request of the story.

    Args:
        operation: As in the document: `GET /changes/{change}`.
        summary: What it is an example of.
        path: Values of the parameters in the path.
        query: Of the address.
        body: None: without one.
        body_type: Media type of the body.
        accept: Media type that is asked for.
        then_s: Time that passes afterwards; with `wait`, meanwhile.
        is_recorded: Whether it is asked of a robot that was just started with a folder of data.
    """

    operation: str
    summary: str
    path: dict[str, str] = field(default_factory=dict)
    query: dict[str, str] = field(default_factory=dict)
    body: Any = None
    body_type: str = JSON
    accept: str = "*/*"
    then_s: float = 0.0
    is_recorded: bool = False


def _waypoints(count: int) -> list[dict[str, float]]:
    return [{"x_m": 2.0 * n, "y_m": 0.0, "yaw_rad": 0.0} for n in range(count)]


SHORT_TASK = {"waypoints": _waypoints(6), "controller": "stanley", "speed_mps": 2.0}
SHORT_CSV = "".join(f"{2 * n}.0,0.0,0.0\n" for n in range(12))
BAD_MODEL = """\
arm:
  ros__parameters:
    type: node
    modes:
      SLOW: {ros__parameters: {max_speed: 0.2}}
"""
SCENARIO = {
    "title": "The battery goes flat",
    "until_s": 1,
    "sample_period_s": 1,
    "steps": [
        {"t_s": 0.5, "reading": {"battery_level": 0.42}},
        {"t_s": 1, "expect": {"system_state": {"state": "ERROR"}}},
    ],
}
FACTS = {
    "targets": {"actuation": "active.PERFORMANCE"},
    "nodes": {
        "drive_base": {"state": "active", "parameters": {"max_speed": 0.2, "controller": "PID"}},
        "manipulator": "active.WEAK",
    },
}
SHUTDOWN = {"transition": "shutdown"}

ACTUATOR = {"part": "actuation"}
BASE = {"part": "drive_base"}
ARM = {"part": "manipulator"}
BATTERY = {"signal": "battery_level"}
OPERATOR = {"owner": "operator"}

LOW_BATTERY = {"error": "BATTERY_LOW"}
LOST_ARM = {"part": "arm", "error": "LOST"}
"""Of a device, which a robot of one computer does not have."""
OVER = {"active": False}
VOLATILE = {"volatile": True}
KNOWN = {"for_s": 600, "reason": "the charger is being mended"}
CHECKPOINTS = {PartName("drive_base"): CheckpointSettings(order={"sense": ("act",)})}
"""What the robot of the story supervises of its nodes."""
PROCESS_OF = PartName("drive_base")
"""The node whose process is run."""

_MODES_AND_STATES = (
    Asked("GET /systems", "After the start"),
    Asked("GET /nodes", "After the start"),
    Asked("GET /systems/{part}/states", "Of a system", ACTUATOR),
    Asked("GET /nodes/{part}/states", "Of a node", BASE),
    Asked("GET /systems/{part}/modes", "What can be entered", ACTUATOR),
    Asked(
        "POST /systems/{part}/mode",
        "What would be done",
        ACTUATOR,
        {"dry_run": "true"},
        {"mode": "PERFORMANCE"},
    ),
    Asked(
        "POST /systems/{part}/mode",
        "Begin, and look later",
        ACTUATOR,
        body={"mode": "PERFORMANCE"},
        then_s=3,
    ),
    Asked("GET /changes/{change}", "It has succeeded", {"change": "c1"}),
    Asked("GET /systems/{part}", "In a mode", ACTUATOR),
    Asked("GET /nodes/{part}", "In a mode", BASE),
    Asked("GET /systems/{part}/state", "In a mode", ACTUATOR),
    Asked("GET /nodes/{part}/state", "In a mode", BASE),
    Asked("GET /systems/{part}/mode", "In a mode", ACTUATOR),
    Asked("GET /nodes/{part}/mode", "In a mode", BASE),
    Asked("GET /nodes/{part}/modes", "What can be entered", BASE),
    Asked("GET /nodes/{part}/parameters", "In a mode", BASE),
    Asked(
        "POST /nodes/{part}/checkpoints/{checkpoint}",
        "In its order",
        {**BASE, "checkpoint": "sense"},
    ),
    Asked(
        "PATCH /nodes/{part}/parameters",
        "Set by hand",
        BASE,
        {"wait": "5"},
        {"max_speed": 0.4},
        then_s=1,
    ),
    Asked("PATCH /nodes/{part}/parameters", "Set back", BASE, body={"max_speed": 0.9}, then_s=1),
    Asked(
        "POST /nodes/{part}/mode",
        "Wait for the end",
        BASE,
        {"wait": "5"},
        {"mode": "SLOW"},
        then_s=3,
    ),
    Asked(
        "POST /nodes/{part}/mode", "Begin, and look later", BASE, body={"mode": "FAST"}, then_s=3
    ),
    Asked(
        "POST /nodes/{part}/state",
        "Deactivate a node",
        BASE,
        body={"transition": "deactivate"},
        then_s=3,
    ),
    Asked(
        "POST /nodes/{part}/state",
        "Activate it again",
        BASE,
        {"wait": "5"},
        {"transition": "activate"},
        then_s=3,
    ),
    Asked(
        "POST /systems/{part}/state",
        "Deactivate all of a system",
        ACTUATOR,
        {"wait": "5"},
        {"transition": "deactivate"},
        then_s=3,
    ),
    Asked("POST /systems/{part}/state", "Activate it", ACTUATOR, body={"transition": "activate"}),
    Asked("DELETE /changes/{change}", "While it runs", {"change": "c8"}, then_s=3),
    Asked("GET /changes", "The newest two", query={"limit": "2"}),
)

_HEALTH = (
    Asked("GET /signals", "All is well"),
    Asked("GET /signals/{signal}", "All is well", BATTERY),
    Asked("GET /signals/{signal}/history", "At most three points", BATTERY, {"points": "3"}),
    Asked("GET /system_state", "All is well"),
    Asked("GET /mock", "All is well"),
    Asked(
        "PATCH /mock/{signal}",
        "Silence a signal",
        {"signal": "temperature"},
        body={"publishing": False},
    ),
    Asked(
        "PATCH /mock/{signal}",
        "Speak again",
        {"signal": "temperature"},
        body={"value": 30.0, "publishing": True},
        then_s=1,
    ),
    Asked("GET /simulated", "All is well"),
    Asked("PATCH /simulated/vehicle", "Lose the pose", body={"fault": "silent"}, then_s=1),
    Asked("PATCH /simulated/vehicle", "Find it again", body={"fault": "recover"}, then_s=1),
    Asked(
        "PATCH /simulated/nodes/{node}",
        "Refuse all commands",
        {"node": "manipulator"},
        body={"fault": "refuse"},
    ),
    Asked(
        "PATCH /simulated/nodes/{node}",
        "Take them again",
        {"node": "manipulator"},
        body={"fault": "recover"},
        then_s=1,
    ),
    Asked("GET /nodes/{part}/process", "One that runs", BASE),
    Asked("POST /nodes/{part}/process", "Restart it", BASE, body={"action": "restart"}),
    Asked("GET /devices", "One that is connected"),
    Asked(
        "PUT /devices/{part}/errors/{error}/shelf",
        "Before its computer is changed",
        LOST_ARM,
        body={"for_s": 600, "reason": "its computer is being changed"},
    ),
    Asked("DELETE /devices/{part}/errors/{error}/shelf", "It is back", LOST_ARM),
    Asked("POST /devices/{part}/errors/{error}/acknowledge", "It is seen", LOST_ARM, body=VOLATILE),
    Asked("GET /monitors", "How fast the battery runs down"),
    Asked("POST /signals/{signal}", "The battery is flat", BATTERY, body={"value": 0.42}),
    Asked("GET /errors", "Those that are on", query={"active": "true"}),
    Asked("GET /analysis", "No error follows from others"),
    Asked("GET /systems/{part}/why", "All is well", ACTUATOR),
    Asked("GET /nodes/{part}/why", "All is well", BASE),
    Asked("GET /systems/{part}/errors", "All is well", ACTUATOR),
    Asked("GET /nodes/{part}/errors", "All is well", BASE),
    Asked("PUT /errors/{error}/shelf", "For ten minutes", LOW_BATTERY, body=KNOWN),
    Asked("DELETE /errors/{error}/shelf", "Announce it again", LOW_BATTERY),
    Asked("POST /errors/{error}/acknowledge", "A flat battery", LOW_BATTERY, body=VOLATILE),
    *(
        asked
        for kind, part in (("systems", ACTUATOR), ("nodes", BASE))
        for asked in (
            Asked(
                f"PUT /{kind}/{{part}}/errors/{{error}}/shelf",
                "For ten minutes",
                {**part, "error": "DEVIATES"},
                body=KNOWN,
            ),
            Asked(
                f"DELETE /{kind}/{{part}}/errors/{{error}}/shelf",
                "Announce it again",
                {**part, "error": "DEVIATES"},
            ),
            Asked(
                f"POST /{kind}/{{part}}/errors/{{error}}/acknowledge",
                "It is seen",
                {**part, "error": "DEVIATES"},
                body=VOLATILE,
            ),
        )
    ),
    *(
        Asked(
            f"POST /{kind}/{{part}}/errors/{{error}}",
            summary,
            part | {"error": error},
            body={"active": active, "message": message, "value": 41.5} if active else OVER,
        )
        for kind, part, error, message in (
            ("systems", ACTUATOR, "BLOCKED", "a box stands in the way"),
            ("nodes", BASE, "OVERCURRENT", "overcurrent, in A"),
        )
        for summary, active in (("It is on", True), ("It is over", False))
    ),
    Asked(
        "POST /systems/{part}/errors/{error}",
        "One that Pilothouse finds itself",
        ACTUATOR | {"error": "DEVIATES"},
        body={"active": True, "message": "the arm is elsewhere"},
    ),
    Asked(
        "POST /nodes/{part}/errors/{error}",
        "One that Pilothouse finds itself",
        BASE | {"error": "UNREACHABLE"},
        body={"active": False},
    ),
    Asked(
        "POST /errors/{error}",
        "One of the robot itself",
        {"error": "BATTERY_LOW"},
        body={"active": False},
    ),
    Asked("GET /reactions", "What they wait for"),
    Asked("GET /systems/{part}/reactions", "What it waits for", ACTUATOR),
    Asked("GET /nodes/{part}/reactions", "What it waits for", BASE),
    *(
        asked
        for kind, reaction in (
            ("systems", ACTUATOR | {"reaction": "COOL_DOWN"}),
            ("nodes", BASE | {"reaction": "RESTART_BASE"}),
        )
        for asked in (
            Asked(
                f"PATCH /{kind}/{{part}}/reactions/{{reaction}}",
                "Only tell when it would act",
                reaction,
                body={"arm": "passive", "reason": "on trial"},
            ),
            Asked(
                f"POST /{kind}/{{part}}/reactions/{{reaction}}/acknowledge",
                "It is seen",
                reaction,
                body=VOLATILE,
            ),
        )
    ),
    Asked(
        "POST /signals",
        "Two at once, from a named sender",
        body={"battery_level": 0.9, "estop": False, "source": "bench"},
        then_s=1,
    ),
    Asked(
        "PUT /emergency_stop", "Engage it", body={"engaged": True, "reason": "smoke"}, then_s=0.1
    ),
    Asked("GET /emergency_stop", "Engaged"),
    Asked("PUT /emergency_stop", "Release it", body={"engaged": False}, then_s=1),
)

_DRIVE = (
    Asked("GET /examples/tracks", "With a simulated vehicle"),
    Asked("GET /examples/tracks/{name}", "The first waypoints", {"name": "loop"}),
    Asked("POST /tasks/preview", "As JSON", body=SHORT_TASK),
    Asked("POST /tasks/preview", "As CSV", body=SHORT_CSV, body_type=CSV),
    Asked("POST /tasks", "As JSON", body=SHORT_TASK),
    Asked(
        "POST /tasks",
        "As CSV, instead of the first",
        query={"speed_mps": "2.5"},
        body=SHORT_CSV,
        body_type=CSV,
        then_s=3,
    ),
    Asked("GET /tasks/current", "On its way"),
    Asked("GET /vehicle", "On its way"),
    Asked("PUT /holds/{owner}", "While loading", OPERATOR, body={"reason": "loading"}),
    Asked("GET /holds", "One hold"),
    Asked("DELETE /holds/{owner}", "Let go", OPERATOR),
    Asked("GET /tasks/{task}", "It was replaced", {"task": "t1"}),
    Asked("GET /tasks/{task}/waypoints", "Three of them", {"task": "t2"}, {"max_points": "3"}),
    Asked("DELETE /tasks/current", "Give it up", then_s=2),
    Asked("GET /tasks", "One was replaced, one given up"),
)

_BESIDE = (
    Asked("GET /model", "What was read"),
    Asked("GET /model", "The file", accept=YAML),
    Asked("POST /model/check", "One that is right", body=ACTUATION, body_type=YAML),
    Asked("POST /model/check", "One with a fault", body=BAD_MODEL, body_type=YAML),
    Asked("POST /inference", "A mode that is not reached", body=FACTS),
    Asked("POST /simulations", "A flat battery", body=SCENARIO),
    Asked("GET /events", "The newest two", query={"limit": "2"}),
    Asked("GET /events/{event}/causes", "Why it is IDLE again", {"event": "206"}),
    Asked(
        "GET /frames",
        "One second after the start",
        query={"at": "2026-01-01T00:00:01Z"},
        is_recorded=True,
    ),
    Asked("GET /livez", "Alive"),
    Asked("GET /readyz", "Ready"),
    Asked("GET /healthz", "Well"),
    Asked("GET /storage", "Of a robot that keeps nothing"),
    Asked("GET /metrics", "Some of them"),
)

_REFUSED = (
    Asked("GET /nodes/{part}", "No such part", {"part": "drive_bas"}),
    Asked("POST /systems/{part}/mode", "A body that is wrong", ACTUATOR, body={"mode": 7}),
    Asked("POST /nodes/{part}/state", "Shut a node down", ARM, {"wait": "5"}, SHUTDOWN, then_s=3),
    Asked("GET /systems/{part}/modes", "What stands against entering them", ACTUATOR),
    Asked(
        "POST /systems/{part}/mode",
        "What stands against it",
        ACTUATOR,
        body={"mode": "PERFORMANCE"},
    ),
)

STORY = (*_MODES_AND_STATES, *_HEALTH, *_DRIVE, *_BESIDE, *_REFUSED)
"""Every operation is in it; what is refused comes last."""
