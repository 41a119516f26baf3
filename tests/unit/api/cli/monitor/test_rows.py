from api.cli.monitor.rows import (
    CALM,
    CHANGES,
    UNREACHABLE,
    WRONG,
    PartRow,
    SignalRow,
    choose,
    part_rows,
)
from api.cli.monitor.store import Json
from tests.support.monitor import named, off_target, part, signal, system


def names(*parts: Json) -> list[str]:
    return [row.name for row in part_rows(named("name", *parts))]


def test_systems_come_before_nodes_and_both_are_in_the_order_of_their_bytes() -> None:
    parts = (part("leg"), system("robot", "arm", "body"), system("body", "leg"), part("Arm"))

    assert names(*parts) == ["body", "robot", "Arm", "leg"]


def test_a_part_of_two_systems_has_one_row() -> None:
    parts = (system("left", "arm"), system("right", "arm"), part("arm"))

    assert names(*parts) == ["left", "right", "arm"]


def test_what_needs_attention_is_marked() -> None:
    assert PartRow(part("arm")).mark == CALM
    assert PartRow(off_target("arm")).mark == WRONG
    assert PartRow(off_target("arm", change="c1")).mark == CHANGES
    assert PartRow(off_target("arm", change="c1", reachable=False)).mark == UNREACHABLE


def test_a_system_is_not_blamed_for_a_node_that_is_not_reachable() -> None:
    assert PartRow(system("robot", "arm", reachable=False)).mark == CALM


def test_a_signal_is_marked_when_it_is_bad_or_about_to_be() -> None:
    assert SignalRow(signal("x")).mark == CALM
    assert SignalRow(signal("x", pending={"error": "E"})).mark == CHANGES
    assert SignalRow(signal("x", error="E")).mark == WRONG
    assert SignalRow(signal("x", stale=True)).mark == WRONG


def test_where_all_fit_they_keep_their_order() -> None:
    rows = [PartRow(part("a")), PartRow(off_target("b"))]

    assert choose(rows, 2).rows == tuple(rows)
    assert choose(rows, None).rows == tuple(rows)


def test_where_they_do_not_fit_what_needs_attention_is_first_and_the_rest_is_counted() -> None:
    rows = [
        PartRow(part("a")),
        PartRow(off_target("b", change="c1")),
        PartRow(off_target("c")),
        PartRow(part("d")),
        PartRow(part("e", reachable=False)),
    ]

    chosen = choose(rows, 4)

    assert [row.name for row in chosen.rows] == ["e", "c", "b"]
    assert (chosen.left_out, chosen.marked) == (2, 0)


def test_marked_ones_for_which_there_is_no_room_are_counted_too() -> None:
    rows = [PartRow(off_target(name)) for name in "abcde"]

    chosen = choose(rows, 3)

    assert len(chosen.rows) == 2
    assert (chosen.left_out, chosen.marked) == (3, 3)


def test_without_room_all_are_counted() -> None:
    chosen = choose([SignalRow(signal("a")), SignalRow(signal("b", stale=True))], 0)

    assert chosen.rows == ()
    assert (chosen.left_out, chosen.marked) == (2, 1)
