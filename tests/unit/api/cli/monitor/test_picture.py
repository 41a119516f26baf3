import pytest

from api.cli.monitor.picture import picture
from api.cli.monitor.store import Json, Robot, fold
from api.cli.monitor.view import Contact, Level, View
from tests.support.monitor import (
    console,
    event,
    frame,
    graph,
    hold,
    named,
    off_target,
    part,
    robot,
    signal,
    system,
    system_state,
    task,
    view,
)

PARTS = (system("robot", "arm", "base"), part("arm"), off_target("base"))
SIGNALS = (signal("battery_level"), signal("estop", value=False), signal("temperature"))
BUSY = (
    frame(
        system_state=system_state("ERROR", "battery is low"),
        task=task("PAUSED"),
        holds=named("owner", hold("operator", "loading"), hold("error", "battery is low")),
    ),
    *(event(number, f"task t{number} drives") for number in range(1, 9)),
)


def busy(*more: Json) -> View:
    return view(robot(*BUSY, *more, parts=PARTS, signals=SIGNALS))


def drawn(seen: View, width: int = 80, height: int | None = None) -> list[str]:
    return [line.plain for line in picture(seen, console(width), height)]


def test_it_tells_how_it_is_then_parts_signals_and_task() -> None:
    lines = drawn(busy(), height=40)

    beginnings = [" ".join(line.split()[:2]) for line in lines]
    order = [
        "System Modes",
        "Model: robot.yaml",
        "ERROR battery",
        "part |",
        "- systems",
        "robot |",
        "- nodes",
        "arm |",
        "! base",
        "(*) =",
        "! base:",
        "signal value",
        "battery_level 1",
        "task t1",
    ]
    assert [word for word in beginnings if word in order] == order


@pytest.mark.parametrize("width", [1, 5, 20, 40, 60, 79, 80, 120])
@pytest.mark.parametrize("height", [1, 2, 3, 5, 8, 12, 16, 20, 24, 25, 26, 27, 28, 29, 30, 40])
def test_it_fits_any_terminal(width: int, height: int) -> None:
    lines = picture(busy(), console(width), height)

    assert len(lines) <= height
    assert all(line.cell_len <= width for line in lines)


@pytest.mark.parametrize("height", range(8, 30))
def test_how_it_is_and_the_task_are_there_however_short_the_terminal_is(height: int) -> None:
    lines = drawn(busy(), height=height)

    assert any(line.startswith("ERROR  battery is low") for line in lines[:3])
    assert any(line.startswith("task t1  PAUSED") for line in lines)


def test_with_more_parts_than_lines_what_deviates_is_there_and_the_rest_is_counted() -> None:
    names = [f"node_{number}" for number in range(200)]
    parts = [system("robot", *names), *(part(name) for name in names[:-1]), off_target("node_199")]
    lines = drawn(view(robot(parts=tuple(parts), signals=SIGNALS)), height=24)

    assert any(line.startswith("!       node_199 | ") for line in lines)
    assert "! node_199: deviates 0 s" in lines
    shown = sum("node_" in line or " robot | " in line for line in lines if " | " in line)
    assert f"  ... and {201 - shown} more parts" in lines
    assert len(lines) == 24


def test_many_reasons_leave_room_for_the_rest() -> None:
    reasons = [f"reason {number}" for number in range(50)]
    state = frame(system_state=system_state("ERROR", *reasons))
    lines = drawn(busy(state), height=24)

    assert "  ... and 43 more lines" in lines
    assert any(line.startswith("!           base | ") for line in lines)


def test_without_a_limit_all_parts_are_there_and_nothing_of_before() -> None:
    names = [f"node_{number}" for number in range(200)]
    parts = (system("robot", *names), *(part(name) for name in names))
    lines = drawn(view(robot(*BUSY, parts=parts)))

    assert sum("node_" in line and " | " in line for line in lines) == 200
    assert not any("drives" in line for line in lines)


def test_where_there_is_room_it_tells_what_happened() -> None:
    lines = drawn(busy(), height=40)

    assert lines[-1].endswith("task t8 drives")


def test_an_old_picture_is_kept_and_dimmed() -> None:
    lost = View("u", busy().robot, Contact(Level.LOST, 9.0), 0.0)
    lines = picture(lost, console(80), 40)

    plain = [line.plain for line in lines]
    assert plain[2].startswith("NO CONTACT")
    assert any(line.startswith("WAS ERROR") for line in plain)
    robots = next(line for line in lines if " robot | " in line.plain)
    assert any(span.style == "dim" for span in robots.spans)


def test_before_anything_is_known_it_says_only_that() -> None:
    waiting = view(Robot(), Contact(Level.CONNECTING, 0.0))

    assert drawn(waiting, height=24)[2:] == ["CONNECTING  waiting for the first values"]


def test_of_a_ros_graph_there_are_only_parts() -> None:
    seen = view(fold(Robot(), graph(*PARTS)))

    lines = drawn(seen)

    assert lines[1] == " Model: models/robot.yaml  http://robot:8000"
    assert any(line.startswith("- nodes ---") for line in lines)
    assert not any(line.startswith(("  signal", "no task", "IDLE")) for line in lines)
