import io
import json

import pytest
from rich.console import Console

from api.cli.monitor.output import ChangeLog, what_stands, write_picture
from api.cli.monitor.store import Json, fold
from api.cli.monitor.view import Contact, Level
from tests.support.monitor import (
    after,
    console,
    event,
    frame,
    hello,
    hold,
    named,
    off_target,
    part,
    robot,
    signal,
    stop,
    system,
    system_state,
    task,
    view,
)

KNOWN = robot(parts=(system("robot", "arm"), part("arm")), signals=(signal("battery_level"),))
DRIVING = fold(robot(parts=(part("arm"),)), frame(task=task()))
CHANGED = fold(KNOWN, frame(parts=named("name", off_target("arm"))))


def text_in(out: Console) -> str:
    assert isinstance(out.file, io.StringIO)
    return out.file.getvalue()


def test_a_picture_as_text_has_no_escape_codes_where_there_is_no_terminal() -> None:
    out = console()

    write_picture(view(CHANGED), "text", out)

    assert "! " in text_in(out)
    assert "\x1b" not in text_in(out)


def test_a_picture_as_json_is_one_object_in_one_line() -> None:
    out = console()

    write_picture(view(KNOWN), "json", out)

    assert text_in(out).count("\n") == 1
    assert json.loads(text_in(out)) == json.loads(json.dumps(KNOWN.as_json()))


def test_a_log_has_a_picture_for_each_change_and_none_for_what_is_none() -> None:
    out = console()
    log = ChangeLog("json", out, io.StringIO())

    for known in (KNOWN, fold(KNOWN, frame(after(1))), CHANGED, CHANGED):
        log.look(view(known))

    states = [json.loads(line)["parts"]["arm"]["converged"] for line in text_in(out).splitlines()]
    assert states == [True, False]


def test_pictures_in_a_log_have_an_empty_line_between_them() -> None:
    out = console()
    log = ChangeLog("text", out, io.StringIO())

    log.look(view(KNOWN))
    log.look(view(CHANGED))

    assert text_in(out).count("\n\n System Modes Monitor - ") == 1
    assert not text_in(out).endswith("\n\n")


def test_as_long_as_something_is_not_known_there_is_no_picture() -> None:
    out = console()

    ChangeLog("text", out, io.StringIO()).look(view(fold(KNOWN, hello("x"))))

    assert text_in(out) == ""


def test_lost_contact_is_told_once_and_is_a_change_of_the_text() -> None:
    out, complaints = console(), io.StringIO()
    log = ChangeLog("text", out, complaints)
    log.look(view(KNOWN))

    for silence_s in (0.0, 1.0):
        log.look(view(KNOWN, Contact(Level.LOST, silence_s, "the connection was lost")))

    assert complaints.getvalue() == "pilothouse: the connection was lost; reconnecting\n"
    assert text_in(out).count("NO CONTACT") == 1


def test_to_programs_only_what_is_true_now_is_told() -> None:
    out, complaints = console(), io.StringIO()

    ChangeLog("json", out, complaints).look(view(KNOWN, Contact(Level.LOST, 0.0, "broke")))

    assert text_in(out) == ""
    assert "broke" in complaints.getvalue()


@pytest.mark.parametrize(
    "message",
    [
        frame(after(1)),
        frame(signals=named("signal", signal("battery_level", 0.5))),
        frame(task=task(progress=0.5, distance_m=400.0)),
        frame(vehicle={"speed_mps": 2.0}),
        event(1),
    ],
)
def test_values_ages_and_ways_are_no_change(message: Json) -> None:
    assert what_stands(fold(DRIVING, message)) == what_stands(DRIVING)


@pytest.mark.parametrize(
    "message",
    [
        frame(system_state=system_state("RUNNING")),
        frame(system_state=system_state("IDLE", "battery is low")),
        frame(system_state={**system_state("RUNNING"), "storage_fault": "the disk is full"}),
        frame(
            system_state={
                **system_state("RUNNING"),
                "reasons": [{"code": "STILL_MOVING", "message": "it moves"}],
            }
        ),
        frame(parts=named("name", part("arm", "inactive"))),
        frame(parts=named("name", part("arm", mode="FAST"))),
        frame(parts=named("name", part("arm", target={"state": "active", "mode": "FAST"}))),
        frame(parts=named("name", off_target("arm"))),
        frame(parts=named("name", part("arm", reachable=False))),
        frame(task=task("PAUSED")),
        frame(task=task(id="t2")),
        frame(task=None),
        frame(holds=named("owner", hold("operator"))),
        frame(emergency_stop=stop(engaged=True)),
        hello("two"),
    ],
)
def test_states_modes_targets_holds_and_the_status_of_the_task_are(message: Json) -> None:
    assert what_stands(fold(DRIVING, message)) != what_stands(DRIVING)
