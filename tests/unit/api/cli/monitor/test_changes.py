import pytest

from api.cli.monitor.changes import standing
from api.cli.monitor.store import Json, fold
from tests.support.monitor import (
    after,
    event,
    frame,
    hello,
    named,
    off_target,
    part,
    robot,
    signal,
    system_state,
    task,
)

KNOWN = fold(robot(parts=(part("arm"),)), frame(task=task()))


@pytest.mark.parametrize(
    "message",
    [
        frame(after(1)),
        frame(signals=named("signal", signal("battery_level", 0.5))),
        frame(task=task(progress=0.5, distance_m=400.0)),
        frame(vehicle={"speed_mps": 2.0}),
        event(1, "task.started", task="t1"),
    ],
)
def test_values_ages_and_ways_are_no_change(message: Json) -> None:
    assert standing(fold(KNOWN, message)) == standing(KNOWN)


@pytest.mark.parametrize(
    "message",
    [
        frame(system_state=system_state("RUNNING")),
        frame(system_state=system_state("IDLE", "battery is low")),
        frame(parts=named("name", part("arm", "inactive"))),
        frame(parts=named("name", part("arm", mode="FAST"))),
        frame(parts=named("name", part("arm", target={"state": "active", "mode": "FAST"}))),
        frame(parts=named("name", off_target("arm"))),
        frame(parts=named("name", part("arm", reachable=False))),
        frame(task=task("PAUSED")),
        frame(task=task(id="t2")),
        frame(task=None),
        event(1, "hold.set", owner="operator", reason=""),
        event(1, "emergency_stop.engaged", reason=""),
        hello("two"),
    ],
)
def test_states_modes_targets_holds_and_the_status_of_the_task_are(message: Json) -> None:
    assert standing(fold(KNOWN, message)) != standing(KNOWN)
