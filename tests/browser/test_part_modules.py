"""The parts of the list of parts that count and do not draw, in the only engine that runs them."""

from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Page

from tests.support.monitor import AT, off_target, part, system

pytestmark = pytest.mark.browser

LINES = 'const lines = await import("/web/js/parts/lines.js");'
VERDICT = 'const verdict = await import("/web/js/parts/verdict.js");'
INDEX = """
const { structureOf, errorsByPart, Looks } = await import("/web/js/parts/part_index.js");
const { treeLines, filtered } = await import("/web/js/parts/lines.js");
const byName = (parts) => Object.fromEntries(parts.map((part) => [part.name, part]));
"""
ERROR = {
    "error": "SILENT",
    "part": "lidar",
    "severity": "urgent",
    "state": "active",
    "suppressed": False,
    "shelved_until_at": None,
    "caused_by": [],
    "message": "lidar has sent nothing for 2 s",
}


def run(page: Page, script: str, given: object = None) -> Any:  # noqa: ANN401 - whatever it returns
    return page.evaluate(f"async (given) => {{ {script} }}", given)


# --- what is wrong with one part -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("given", "errors", "look"),
    [
        (part("lidar"), [], "normal"),
        (part("lidar", "unknown"), [], "unknown"),
        (part("lidar", change="c1", converged=False), [], "changing"),
        (off_target("lidar"), [], "deviating"),
        (off_target("lidar", reachable=False), [], "unreachable"),
        (part("lidar"), [ERROR], "faulty"),
        (part("lidar"), [ERROR | {"severity": "warning"}], "warned"),
        # These say once more what the target and the actual state say.
        (off_target("lidar"), [ERROR | {"error": "DEVIATES", "severity": "warning"}], "deviating"),
        (part("lidar"), [ERROR | {"error": "DEVIATES", "severity": "warning"}], "normal"),
        # A change that was rolled back.
        (part("lidar"), [ERROR | {"error": "CHANGE_FAILED", "severity": "warning"}], "warned"),
        # A system is reachable as its nodes are.
        (system("base", "lidar", reachable=False), [], "normal"),
    ],
)
def test_a_part_looks_as_the_worst_that_is_wrong_with_it(
    page: Page, given: dict[str, Any], errors: list[dict[str, Any]], look: str
) -> None:
    script = VERDICT + "return verdict.lookOf(given.part, given.errors);"
    assert run(page, script, {"part": given, "errors": errors}) == look


FAST = {"state": "active", "mode": "FAST"}


@pytest.mark.parametrize(
    ("given", "errors", "words"),
    [
        (part("lidar"), [], ""),
        (part("lidar"), [ERROR], "silent: has sent nothing for 2 s"),
        (
            part("lidar"),
            [ERROR | {"caused_by": [{"part": "switch", "error": "UNREACHABLE"}]}],
            "silent because of switch UNREACHABLE",
        ),
        (
            part("lidar"),
            [ERROR | {"caused_by": [{"part": None, "error": "BATTERY_LOW"}]}],
            "silent because of BATTERY_LOW",
        ),
        (
            part("lidar", reachable=False),
            [ERROR | {"error": "UNREACHABLE", "message": "lidar was never heard of"}],
            "was never heard of",
        ),
        (
            part("lidar", reachable=False, device="arm"),
            [ERROR | {"error": "UNREACHABLE", "caused_by": [{"part": "arm", "error": "LOST"}]}],
            "device arm is lost",
        ),
        (part("lidar", reachable=False), [], "unreachable"),
        (
            system(
                "eyes",
                "camera",
                converged=False,
                deviation_reason="camera is active.SLOW",
            ),
            [],
            "because camera is SLOW",
        ),
        (
            system(
                "eyes",
                "front/camera",
                converged=False,
                deviation_reason="front/camera is active.__DEFAULT__, target active.FAST",
            ),
            [],
            "because camera is default",
        ),
        (off_target("lidar"), [], "target active.FAST, no change is under way"),
        (
            off_target("lidar"),
            [ERROR | {"error": "CHANGE_FAILED", "message": "change c1 failed: refused"}],
            "change c1 failed: refused",
        ),
    ],
)
def test_the_cause_is_told_in_one_short_line(
    page: Page, given: dict[str, Any], errors: list[dict[str, Any]], words: str
) -> None:
    script = VERDICT + "return verdict.causeWords(given.part, given.errors);"
    assert run(page, script, {"part": given, "errors": errors}) == words


def test_where_a_system_is_unknown_the_node_that_hides_it_is_the_cause(page: Page) -> None:
    hidden = {
        **system("motion", "left/brake", converged=False, deviation_reason="left/brake is unknown"),
        "actual": {"state": "unknown", "reason": "left/brake is unreachable"},
    }
    script = VERDICT + "return verdict.causeWords(given);"
    assert run(page, script, hidden) == "because brake is unreachable"


# --- names ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "start", "end"),
    [
        ("manipulator", "manipulator", ""),
        ("camera_wheel_003", "camera_wheel", "_003"),
        ("front_left_wheel_observer", "front_left_wheel_ob", "server"),
        ("frontleftwheelobserver", "frontleftwheelob", "server"),
    ],
)
def test_a_long_name_keeps_the_end_that_tells_it_from_others(
    page: Page, name: str, start: str, end: str
) -> None:
    assert run(page, LINES + "return lines.splitName(given);", name) == [start, end]


def test_siblings_of_a_namespace_stand_together_below_its_name(page: Page) -> None:
    names = ["left/motor", "clock", "left/brake", "right/motor"]
    shown = run(
        page,
        INDEX
        + """
        const parts = byName(given.map((name) => ({ name, parts: [] })));
        return treeLines(structureOf(parts), () => true)
            .map(({ heading, shown, space, index }) => heading ?? [shown, space, index]);
        """,
        names,
    )
    assert shown == [
        "left",
        ["motor", "", 1],
        ["brake", "", 2],
        ["clock", "", 3],
        ["motor", "right", 4],
    ]


# --- all parts at once ---------------------------------------------------------------------------

ROBOT = [
    system("robot", "base", "eyes"),
    system("base", "motor", "clock"),
    system("eyes", "camera", "clock"),
    part("motor"),
    part("camera"),
    part("clock"),
]


def test_a_part_in_two_systems_has_a_line_in_each(page: Page) -> None:
    lines = run(
        page,
        INDEX + "return treeLines(structureOf(byName(given)), () => true).map(({ key }) => key);",
        ROBOT,
    )
    assert [key.split("\n")[-1] for key in lines] == [
        "robot",
        "base",
        "motor",
        "clock",
        "eyes",
        "camera",
        "clock",
    ]
    assert len(set(lines)) == len(lines)


def test_a_filter_keeps_what_matches_and_the_way_to_it(page: Page) -> None:
    found = run(
        page,
        INDEX
        + """
        const { found, kept, leading } = filtered(structureOf(byName(given)), ["cam"]);
        return [[...found], [...kept], [...leading]];
        """,
        ROBOT,
    )
    assert found == [["camera"], ["camera", "robot", "eyes"], ["robot", "eyes"]]


def test_a_system_that_matches_keeps_what_it_contains(page: Page) -> None:
    kept = run(
        page,
        INDEX + 'return [...filtered(structureOf(byName(given)), ["bas"]).kept].sort();',
        ROBOT,
    )
    assert kept == ["base", "clock", "motor", "robot"]


def test_the_structure_stays_the_same_object_until_a_system_gets_another_part(page: Page) -> None:
    same = run(
        page,
        INDEX
        + """
        const parts = byName(given);
        const first = structureOf(parts);
        const changed = { ...parts, base: { ...parts.base, parts: [...parts.base.parts] } };
        const second = structureOf(changed, first);
        const other = { ...parts, base: { ...parts.base, parts: ["motor"] } };
        const fewer = { ...parts };
        delete fewer.camera;
        return [second === first, structureOf(other, first) === first,
                structureOf(fewer, first) === first];
        """,
        ROBOT,
    )
    assert same == [True, False, False]


def test_attention_begins_at_the_deepest_and_each_system_counts_what_is_below_it_once(
    page: Page,
) -> None:
    broken = {"converged": False, "deviation_since_at": AT}
    robot = [
        *[{**each, **broken} for each in ROBOT[:3]],
        off_target("motor"),
        part("camera"),
        part("clock", reachable=False),
    ]
    told = run(
        page,
        INDEX
        + """
        const looks = new Looks();
        const structure = structureOf(byName(given));
        const isChanged = looks.take(structure, new Map());
        const again = looks.take(structure, new Map());
        const below = Object.fromEntries(given.map(({ name }) => [name, looks.below(name)]));
        return { isChanged, again, attention: looks.attention, begins: [...looks.begins], below };
        """,
        robot,
    )
    assert told["isChanged"]
    assert not told["again"]
    assert told["attention"] == ["clock", "motor", "robot", "base", "eyes"]
    assert sorted(told["begins"]) == ["clock", "motor"]
    assert told["below"]["robot"] == {"worst": "unreachable", "count": 2}
    assert told["below"]["eyes"] == {"worst": "unreachable", "count": 1}
    assert told["below"]["motor"] is None


def test_an_error_that_is_silenced_or_over_asks_for_no_attention(page: Page) -> None:
    errors = {
        "a": ERROR,
        "b": ERROR | {"part": "camera", "suppressed": True},
        "c": ERROR | {"part": "motor", "shelved_until_at": AT},
        "d": ERROR | {"part": "clock", "state": "returned"},
        "e": ERROR | {"part": None},
    }
    assert run(page, INDEX + "return [...errorsByPart(given).keys()];", errors) == ["lidar"]


# --- since when ----------------------------------------------------------------------------------


def test_since_when_a_part_is_in_its_state_is_known_from_events_but_not_before_they_were(
    page: Page,
) -> None:
    times = run(
        page,
        """
        const { StateTimes } = await import("/web/js/parts/state_times.js");
        const times = new StateTimes();
        const event = (id, at, part) => ({ id, kind: "part.actual_changed", at, data: { part } });
        const [one, two] = ["2026-01-01T00:00:01Z", "2026-01-01T00:00:05Z"];
        const late = Date.parse("2026-01-01T00:01:00Z");
        times.take([event(7, two, "motor")]);
        const newest = times.of("motor", late);
        times.take([event(3, one, "clock"), event(7, two, "motor")]);
        return [newest === Date.parse(two), times.of("clock", late) === Date.parse(one),
                times.of("motor", Date.parse(one)), times.of("camera", late)];
        """,
    )
    assert times == [True, True, None, None]


# --- squares -------------------------------------------------------------------------------------


def test_more_nodes_make_smaller_squares_and_each_is_found_where_it_is(page: Page) -> None:
    told = run(
        page,
        """
        const shapes = await import("/web/js/parts/square_shapes.js");
        const paths = shapes.squarePaths(["normal", "unreachable", "normal"], 2);
        return {
            columns: [1, 300, 1000, 10000].map(shapes.columnsFor),
            begins: [...paths.normal.matchAll(/M[^a-z]*/g)].map(([begin]) => begin),
            other: paths.unreachable.startsWith("M1 0"),
            at: [[0.5, 0.5], [1.5, 0.5], [0.5, 1.5], [1.5, 1.5], [-1, 0], [3, 0]]
                .map(([x, y]) => shapes.squareAt(x, y, 2, 3)),
        };
        """,
    )
    assert told["columns"] == [26, 26, 42, 74]
    assert told["begins"] == ["M0 0", "M0 1"]
    assert told["other"]
    assert told["at"] == [0, 1, 2, -1, -1, -1]
