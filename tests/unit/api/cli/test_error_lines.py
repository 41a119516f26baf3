"""The lines in which an operator reads errors."""

from typing import Any

from api.cli.error_lines import error_lines, error_name, is_on

LIDAR = {"part": "lidar", "error": "SILENT"}


def item(error: str, part: str | None = None, **more: object) -> dict[str, Any]:
    """Return an error as it is listed: active and its own root, unless told otherwise."""
    return {
        "error": error,
        "part": part,
        "severity": "urgent",
        "state": "active",
        "shelved_until_at": None,
        "shelved_because": None,
        "suppressed": False,
        "chattering": False,
        "root_cause": True,
        "first_out": False,
        "caused_by": [],
        "roots": [{"part": part, "error": error}],
        "message": "it is so",
        "since_at": "2026-05-04T12:00:00.000Z",
        "count": 1,
        "hint": None,
        **more,
    }


def names(*items: dict[str, Any]) -> list[str]:
    """Return state and name of each line, with the indentation."""
    return [line.partition(":")[0].rstrip() for line in error_lines(items)]


def test_an_error_is_told_with_what_is_known_of_it() -> None:
    (line,) = error_lines(
        [item("SILENT", "lidar", first_out=True, count=3, hint="clean the lens", state="latched")]
    )
    assert line == (
        "latched       urgent    lidar.SILENT: it is so  [first]"
        "  [since 2026-05-04T12:00:00.000Z]  [3 times]  [clean the lens]"
    )


def test_what_follows_from_an_error_stands_below_it() -> None:
    late = item("LATE", "mapper", root_cause=False, roots=[LIDAR], severity="critical")
    assert names(late, item("BATTERY_LOW"), item("SILENT", "lidar")) == [
        "active        urgent    BATTERY_LOW",
        "active        urgent    lidar.SILENT",
        "  active        critical  mapper.LATE",
    ]


def test_what_follows_from_an_error_that_is_not_listed_stands_by_itself() -> None:
    late = item("LATE", "mapper", root_cause=False, roots=[LIDAR])
    assert names(late) == ["active        urgent    mapper.LATE"]


def test_what_needs_somebody_comes_first() -> None:
    assert names(
        item("A", state="returned"),
        item("B", severity="warning"),
        item("C", severity="fatal"),
        item("D", state="pending"),
    ) == [
        "active        fatal     C",
        "active        warning   B",
        "pending       urgent    D",
        "returned      urgent    A",
    ]


def test_what_is_silenced_comes_last_with_its_count_and_reason() -> None:
    until = "2026-05-04T20:00:00.000Z"
    shelved = item("LOUD", shelved_until_at=until, shelved_because="known")
    lines = list(error_lines([shelved, item("DIM", suppressed=True), item("SILENT", "lidar")]))
    assert "lidar.SILENT" in lines[0]
    assert lines[1] == "not announced (2):"
    assert lines[2].endswith(f"[shelved until {until}: known]")
    assert lines[3].endswith("[suppressed]")


def test_an_error_is_on_whether_it_was_acknowledged_or_not() -> None:
    on = {state for state in ("active", "acknowledged", "latched") if is_on(item("A", state=state))}
    assert on == {"active", "acknowledged", "latched"}
    assert not is_on(item("A", state="returned"))


def test_an_error_of_a_part_has_the_part_in_its_name() -> None:
    assert error_name(item("SILENT", "left/lidar")) == "left/lidar.SILENT"
    assert error_name(item("ESTOP")) == "ESTOP"
