import pytest
from rich.text import Text

from api.cli.monitor.part_block import LEGEND, PartBlock
from api.cli.monitor.rows import part_rows
from api.cli.monitor.store import Json
from tests.support.monitor import (
    AT,
    console,
    device,
    frame,
    named,
    off_target,
    part,
    robot,
    system,
    view,
)

FAST: Json = {"state": "active", "mode": "FAST"}
NAMES = [f"node_{number}" for number in range(1_000)]


def plain(lines: list[Text]) -> list[str]:
    return [line.plain.rstrip() for line in lines]


def drawn(
    *parts: Json,
    width: int = 80,
    room: int | None = None,
    later_s: float = 0.0,
    more: tuple[Json, ...] = (),
) -> list[str]:
    seen = view(robot(*more), later_s=later_s)
    block = PartBlock(seen, part_rows(named("name", *parts)), console(width))
    return plain(block.lines(room))


def notes(*parts: Json, later_s: float = 0.0, more: tuple[Json, ...] = ()) -> list[str]:
    """Return what is beneath the table."""
    lines = drawn(*parts, later_s=later_s, more=more)
    return lines[lines.index(f" {LEGEND}") + 1 :]


def starred(given: Json) -> Json:
    return {**given, "actual": {**given["actual"], "mode_inferred": True}}


def pursued(mode: str, because: str, rule: str | None = None, *messages: str) -> Json:
    blockers = [{"message": message} for message in messages]
    goal = {"state": "active", "mode": mode}
    return {**goal, "because": because, "rule": rule, "blockers": blockers}


def test_it_has_the_columns_and_sections_of_the_mode_monitor() -> None:
    base = starred(part("drive_base", mode="SLOW", target={"state": "active", "mode": "SLOW"}))
    arm = part("manipulator", "inactive", target={"state": "inactive", "mode": None})
    whole = system("actuation", "drive_base", "manipulator", target=FAST)

    assert drawn(whole, base, arm, width=99) == [
        "                       part |                             state |"
        "                              mode",
        "                            |          target |          actual |"
        "          target |          actual",
        "- systems -----------------------------------------"
        "------------------------------------------------",
        "                  actuation |          active |       active(*) |            FAST |",
        "- nodes -------------------------------------------"
        "------------------------------------------------",
        "                 drive_base |          active |          active |"
        "            SLOW |         SLOW(*)",
        "                manipulator |        inactive |        inactive |                 |",
        "---------------------------------------------------"
        "------------------------------------------------",
        " (*) = inferred   ! deviation or error   > changing or pending   x unreachable",
    ]


def test_usual_names_keep_their_places_in_a_terminal_of_80() -> None:
    before = drawn(part("manipulator", "inactive"))
    target = {"state": "deactivating", "mode": "PERFORMANCE"}
    after = drawn(starred(part("manipulator", "deactivating(*)", "__DEFAULT__", target=target)))

    assert [len(line) for line in before[:2]] == [len(line) for line in after[:2]]
    assert max(map(len, after)) <= 80


def test_what_is_pursued_counts_more_than_what_was_asked() -> None:
    base = part("base", target=FAST, effective_target=pursued("SLOW", "rule", "slow_down"))

    lines = drawn(base)

    assert not any("FAST" in line for line in lines)
    assert any("SLOW" in line for line in lines)
    assert notes(base) == ["  base: rule slow_down"]


def test_who_set_a_target_is_told_beside_how_long_the_part_deviates() -> None:
    arm = off_target("arm", effective_target=pursued("SLOW", "rule", "slow_down"))

    assert notes(arm, later_s=12.0) == ["! arm: deviates 12 s, rule slow_down"]


def test_a_fallback_says_which_invariant_is_broken() -> None:
    base = part("base", mode="SLOW", effective_target=pursued("SLOW", "invariant", None, "too hot"))

    assert notes(base) == ["  base: invariant: too hot"]


def test_a_target_that_was_requested_needs_no_word_more() -> None:
    assert notes(part("base", mode="FAST", effective_target=pursued("FAST", "requested"))) == []


def test_a_deviation_is_marked_and_its_time_counted() -> None:
    arm = off_target("arm")

    assert any(line.startswith("!            arm | ") for line in drawn(arm))
    assert notes(arm, later_s=12.0) == ["! arm: deviates 12 s"]


def test_a_system_that_is_there_by_name_tells_which_of_its_parts_is_not() -> None:
    reason = "arm is unconfigured, target inactive"
    deviates: Json = {"converged": False, "deviation_since_at": AT, "deviation_reason": reason}
    target = {"state": "inactive", "mode": None}
    whole = system("robot", "arm", state="inactive", target=target, **deviates)
    arm = part("arm", "unconfigured", target=target, **deviates)

    assert notes(whole, arm, later_s=12.0) == [
        f"! robot: deviates 12 s: {reason}",
        # Its own deviation is in its columns.
        "! arm: deviates 12 s",
    ]


def test_a_part_that_changes_is_marked_as_changing() -> None:
    assert notes(off_target("arm", change="c1"), later_s=3.0) == ["> arm: changing 3 s"]


def test_a_node_that_is_not_reachable_says_so_in_a_word() -> None:
    assert notes(part("arm", reachable=False)) == ["x arm: unreachable"]


def test_why_a_part_cannot_be_judged_is_told_in_the_words_of_the_service() -> None:
    lost = part("arm", "unknown")
    why = {**lost, "actual": {**lost["actual"], "undecidable": True, "reason": "never reported"}}

    assert any(line.split()[:4] == ["arm", "|", "|", "?"] for line in drawn(why))
    assert notes(why) == ["  arm: never reported"]


def test_a_long_reason_wraps_beneath_the_table() -> None:
    long = "x is " + "very " * 30 + "late"
    arm = off_target("arm", deviation_reason=long)

    told = notes(arm)

    assert len(told) > 1
    assert all(line.startswith("    ") for line in told[1:])


def test_a_narrow_terminal_shows_what_a_part_is_in_and_its_mark() -> None:
    lines = drawn(off_target("arm"), width=40)

    assert lines[1].split() == ["|", "actual", "|", "actual"]
    assert any(line.split() == ["!", "arm", "|", "inactive", "|"] for line in lines)


@pytest.mark.parametrize("room", range(41))
@pytest.mark.parametrize("count", [0, 1, 3, 20, 1_000])
def test_it_takes_no_more_lines_than_it_is_given(count: int, room: int) -> None:
    nodes = [off_target(name) if n % 3 else part(name) for n, name in enumerate(NAMES[:count])]

    assert len(drawn(system("robot", *NAMES[:count]), *nodes, room=room)) <= room


def test_of_a_thousand_parts_what_needs_attention_is_there_with_its_reason() -> None:
    nodes = [part(name) for name in NAMES[:-1]]
    lines = drawn(system("robot", *NAMES), *nodes, off_target("node_999"), room=12, later_s=4.0)

    assert lines[2].startswith("- systems ")
    assert any(line.startswith("!       node_999 | ") for line in lines)
    assert lines[-2:] == ["  ... and 995 more parts", "! node_999: deviates 4 s"]


def test_a_short_table_has_no_sections() -> None:
    nodes = [part(name) for name in NAMES[:9]]

    lines = drawn(*nodes, room=6)

    assert not any(line.startswith("- ") for line in lines)
    assert lines[-1] == "  ... and 6 more parts"


def test_where_not_even_a_row_fits_there_are_no_titles() -> None:
    assert drawn(part("arm"), room=2) == []


def test_a_name_cannot_move_the_cursor() -> None:
    assert not any("\x1b" in line for line in drawn(off_target("arm\x1b[2J")))


ON_DEVICES = (frame(devices=named("device", device("arm", "lost"), device("base"))),)


def test_a_part_says_on_which_device_it_is() -> None:
    lines = drawn(part("drive_base", device="base"), more=ON_DEVICES)

    assert any("drive_base (base) | " in line for line in lines)


def test_a_part_of_a_lost_device_is_told_as_it_was_and_how_old_that_is() -> None:
    arm = off_target("drive_base", reachable=False, device="arm", last_known=FAST)

    told = notes(arm, later_s=12, more=ON_DEVICES)

    assert told == ["x drive_base: was active.FAST 12 s ago"]


def test_a_part_of_which_nothing_was_known_is_only_unreachable() -> None:
    arm = off_target("drive_base", reachable=False, device="arm", last_known=None)

    assert notes(arm, later_s=12, more=ON_DEVICES) == ["x drive_base: unreachable for 12 s"]
