"""What page and terminal say of the computers of a robot: cases that both are tried with."""

from collections.abc import Mapping
from dataclasses import dataclass

from api.cli.monitor.store import Json
from tests.support.monitor import device, named, stop


@dataclass(frozen=True, slots=True)
class DeviceCase:
    """Devices of a robot, and what is said of them."""

    name: str
    devices: Mapping[str, Json]
    amiss: tuple[str, ...] = ()
    problems: tuple[str, ...] = ()
    not_stopped: str = ""


def devices(**states: str) -> Mapping[str, Json]:
    """Return devices in these states."""
    return named("device", *(device(name, state) for name, state in states.items()))


def stopped_at(*places: str | None, not_heard: tuple[str, ...] = ()) -> Json:
    """Return an emergency stop that is engaged on these computers; None: on this one."""
    stops = [{"id": f"s{number}", "device": place} for number, place in enumerate(places)]
    return stop(engaged=True, stops=stops, waits_for=[], not_heard=list(not_heard))


PLACES: tuple[tuple[Json, str], ...] = (
    (stop(engaged=True), ""),
    (stopped_at(None), ""),
    (stopped_at("arm"), "at device arm"),
    (stopped_at("arm", "arm", not_heard=("arm", "base")), "at device arm (not heard)"),
    (
        stopped_at("arm", None, "supervisor", not_heard=("supervisor",)),
        "at device arm, here and at the supervisor (not heard)",
    ),
    (stopped_at("a", "b", "c", "d", "e"), "at device a, at device b, at device c and 2 more"),
)
"""Emergency stops, and where they are engaged in words."""

CASES = (
    DeviceCase("one computer", {}),
    DeviceCase("all are heard", devices(arm="connected", base="connected")),
    DeviceCase("one is late", devices(arm="late", base="connected"), ("arm late",)),
    DeviceCase(
        "one is lost",
        devices(arm="lost", base="connected"),
        ("arm lost",),
        ("device arm is lost",),
        "arm is not known to be stopped",
    ),
    DeviceCase(
        "the worst comes first",
        devices(arm="late", base="never_seen", cart="conflict", door="lost"),
        ("door lost", "cart in conflict", "base not seen yet", "arm late"),
        ("device door is lost", "device cart is in conflict", "device base is not seen yet"),
        "door, cart and base are not known to be stopped",
    ),
    DeviceCase(
        "more than can be named",
        devices(a="lost", b="lost", c="lost", d="lost", e="lost"),
        ("a lost", "b lost", "c lost", "d lost", "e lost"),
        (
            "device a is lost",
            "device b is lost",
            "device c is lost",
            "2 more such devices",
        ),
        "a, b, c and 2 more are not known to be stopped",
    ),
)
