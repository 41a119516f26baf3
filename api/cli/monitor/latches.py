"""What an event says of holds and of the emergency stop, which no frame carries.

So both fit the frame that follows; the answer to a request, which comes later, has the last word.
"""

from collections.abc import Mapping
from typing import Any

from domain.tasks.holds import RESERVED

Json = Mapping[str, Any]


def holds_after(holds: tuple[Json, ...], event: Json) -> tuple[Json, ...]:
    """Return the holds, the oldest first, after an event.

    Args:
        holds: Those before.
        event: Of any kind.
    """
    owner = event["data"].get("owner")
    others = tuple(hold for hold in holds if hold["owner"] != owner)
    if event["kind"] == "hold.released":
        return others
    if event["kind"] != "hold.set":
        return holds
    hold = {
        "owner": owner,
        "reason": event["data"]["reason"],
        "by": "" if owner in RESERVED else event["actor"],
        "since_at": event["at"],
    }
    return (*others, hold)


def stop_after(stop: Json, event: Json) -> Json:
    """Return the emergency stop after an event.

    Args:
        stop: As it was before.
        event: Of any kind.
    """
    kind, at = event["kind"], event["at"]
    if kind == "emergency_stop.standstill":
        return {**stop, "standstill_at": at}
    if kind not in ("emergency_stop.engaged", "emergency_stop.released"):
        return stop
    return {
        "engaged": kind == "emergency_stop.engaged",
        "by": event["actor"],
        "reason": event["data"]["reason"],
        "since_at": at,
        "standstill_at": None,
    }
