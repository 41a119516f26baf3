"""The parts of the map that count and do not draw, in the only engine that runs them."""

import itertools
import math
import re
from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Page

pytestmark = pytest.mark.browser

# 100 points one metre apart, of which every tenth is kept.
THINNED = """
const { PathShape } = await import("/web/js/map/path_shape.js");
const items = Array.from({ length: 11 }, (_, n) => ({ x_m: 10 * n, y_m: 0 }));
const path = new PathShape(items, items.map((_, n) => 10 * n));
"""
TRAIL = """
const { Trail } = await import("/web/js/map/trail.js");
const trail = new Trail();
const add = (x_m, s, state = "RUNNING") => trail.add({ x_m, y_m: 0, yaw_rad: 0 }, 1000 * s, state);
"""
VIEW = """
const looks = await import("/web/js/map/view.js");
const view = { ...looks.emptyView(), width: 600, height: 400, x_m: 3, y_m: -7, scale: 8 };
"""
WORDS = 'const words = await import("/web/js/base/task_words.js");'


def run(page: Page, script: str) -> Any:  # noqa: ANN401 - whatever the script returns
    return page.evaluate(f"async () => {{ {script} }}")


def test_the_part_that_is_done_ends_beside_the_vehicle(page: Page) -> None:
    split = run(page, THINNED + "return path.split(43, { x_m: 42.5, y_m: 1.2 });")
    assert split == {"segment": 4, "place": {"x_m": 42.5, "y_m": 0}}


def test_a_vehicle_that_was_carried_away_does_not_move_what_is_done_past_the_kept_points(
    page: Page,
) -> None:
    split = run(page, THINNED + "return path.split(43, { x_m: 95, y_m: 0 });")
    assert split == {"segment": 4, "place": {"x_m": 50, "y_m": 0}}


def test_before_the_first_waypoint_nothing_is_done(page: Page) -> None:
    split = run(page, THINNED + "return path.split(0, { x_m: 7, y_m: 0 });")
    assert split == {"segment": 0, "place": {"x_m": 0, "y_m": 0}}


def test_the_target_of_a_thinned_path_is_the_next_point_that_was_kept(page: Page) -> None:
    assert run(page, THINNED + "return path.waypoint(41).x_m;") == 50
    assert run(page, THINNED + "return path.waypoint(100).x_m;") == 100


def test_a_trail_tells_the_states_apart_and_leaves_no_gap_between_them(page: Page) -> None:
    script = 'add(0, 0); add(1, 1); add(2, 2, "ERROR"); return trail.runs.map((run) => [run.state,'
    runs = run(page, TRAIL + script + "run.bounds.minX, run.bounds.maxX]);")
    assert runs == [["RUNNING", 0, 1], ["ERROR", 1, 2]]


def test_a_trail_is_not_drawn_over_a_way_that_nobody_saw(page: Page) -> None:
    bounds = "return trail.runs.map((run) => [run.bounds.minX, run.bounds.maxX]);"
    assert run(page, TRAIL + "add(0, 0); add(1, 1); add(2, 9);" + bounds) == [[0, 1], [2, 2]]
    assert run(page, TRAIL + "add(0, 0); add(1, 1); add(50, 2);" + bounds) == [[0, 1], [50, 50]]


def test_a_trail_forgets_what_is_older_than_five_minutes(page: Page) -> None:
    script = "add(0, 0); add(1, 1); for (let s = 2; s < 310; s += 1) add(1, s); add(2, 310);"
    assert run(page, TRAIL + script + "return trail.runs.length;") == 1


def test_a_vehicle_at_rest_makes_its_trail_no_longer(page: Page) -> None:
    script = "add(0, 0); const was = trail.version; for (let n = 1; n < 50; n += 1) add(0, n / 20);"
    assert run(page, TRAIL + script + "return trail.version === was;") is True


def test_a_trail_of_a_pinned_moment_ends_where_the_vehicle_was_then(page: Page) -> None:
    script = 'add(0, 0); add(1, 1); add(2, 2); add(3, 2.5, "HELD"); add(4, 3, "HELD");'
    runs = "return trail.until(%s).map((run) => [run.state, run.bounds.minX, run.bounds.maxX]);"
    assert run(page, TRAIL + script + runs % "1500") == [["RUNNING", 0, 1]]
    assert run(page, TRAIL + script + runs % "2700") == [["RUNNING", 0, 2], ["HELD", 2, 3]]
    assert run(page, TRAIL + script + runs % "9000") == [["RUNNING", 0, 2], ["HELD", 2, 4]]
    assert run(page, TRAIL + script + runs % "-1") == []


def test_what_rests_of_a_trail_changes_only_when_a_run_begins_or_is_forgotten(page: Page) -> None:
    script = """
        add(0, 0); add(1, 1);
        const before = trail.settled;
        add(2, 2); add(3, 3);
        const same = trail.settled === before;
        add(4, 4, "ERROR");
        return [same, trail.settled > before];
    """
    assert run(page, TRAIL + script) == [True, True]


NUMBERS = """
const { drawNumbers } = await import("/web/js/map/waypoints.js");
const { PathShape } = await import("/web/js/map/path_shape.js");
const looks = await import("/web/js/map/view.js");
const numbers = (scale) => {
    const said = [];
    const context = { strokeText() {}, fillText: (text) => said.push(text) };
    const path = new PathShape(Array.from({ length: 100 }, (_, n) => ({ x_m: n, y_m: 0 })));
    const view = { ...looks.emptyView(), x_m: 50, width: 1000, height: 400, scale };
    drawNumbers(context, view, { font: "11px sans-serif" }, path);
    return said;
};
"""


@pytest.mark.parametrize(
    ("scale", "first", "step"), [(9, 10, 10), (12, 5, 5), (30, 34, 2), (60, 33, 1)]
)
def test_waypoints_are_numbered_from_one_as_densely_as_there_is_room(
    page: Page, scale: int, first: int, step: int
) -> None:
    said = [int(number) for number in run(page, NUMBERS + f"return numbers({scale});")]
    assert said[0] <= first
    assert all(number % step == 0 for number in said)
    assert {later - earlier for earlier, later in itertools.pairwise(said)} == {step}


def test_waypoints_that_would_touch_have_no_numbers(page: Page) -> None:
    assert run(page, NUMBERS + "return numbers(4);") == []


def test_what_moves_by_itself_is_drawn_ten_times_a_second_and_what_is_moved_at_once(
    page: Page,
) -> None:
    script = """
        const { Pace } = await import("/web/js/map/pace.js");
        const at = [];
        const pace = new Pace(() => at.push(performance.now()));
        const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
        for (let n = 0; n < 40; n += 1) { pace.soon(); await wait(10); }
        await wait(200);
        const slow = at.slice(1).map((now, n) => now - at[n]);
        pace.soon();
        await wait(60);
        const begin = performance.now();
        pace.now();
        await wait(200);
        return [Math.min(...slow), at.at(-1) - begin];
    """
    least, waited = run(page, script)
    assert least >= 99
    assert waited < 99


STRIP = """
const { heldWords, stripWords } = await import("/web/js/task/strip_words.js");
const at = Date.parse("2026-01-02T03:04:05Z");
const task = { id: "t1", status: "RUNNING", controller: "stanley", progress: 0.625,
    target_index: 40, waypoint_count: 66, length_m: 800, distance_m: 500, speed_mps: 2.5,
    cross_track_error_m: -0.034, reason: null, created_at: "2026-01-02T03:00:00Z", ended_at: null };
const say = (more, vehicle = { speed_mps: 2.8 }) =>
    stripWords({ systemState: {}, vehicle, task: more && { ...task, ...more } }, { at });
"""


def test_the_strip_tells_a_running_task_in_one_line(page: Page) -> None:
    said = run(page, STRIP + "return say({});")
    assert (said["word"], said["name"]) == ("RUNNING", "task t1, 62 %")
    assert said["way"] == "Waypoint 41 of 66"
    [(eta, left), *others] = said["readings"]
    assert eta.startswith("ETA ")
    assert left == "2 min"
    assert others == [["Off path", "0.03 m right"], ["Speed", "2.8 m/s"]]


@pytest.mark.parametrize(
    ("more", "word", "way"),
    [
        ("null", "NO TASK", "The vehicle has no path to drive."),
        ('{ status: "PAUSED" }', "HELD", "Waypoint 41 of 66"),
        ('{ status: "PAUSING" }', "STOPPING", "Waypoint 41 of 66"),
    ],
)
def test_the_strip_has_a_word_for_none_and_for_what_holds(
    page: Page, more: str, word: str, way: str
) -> None:
    said = run(page, STRIP + f"return say({more});")
    assert (said["word"], said["way"]) == (word, way)


def test_before_the_first_frame_the_strip_says_that_nothing_is_known(page: Page) -> None:
    said = run(page, STRIP + "return stripWords({ systemState: null, task: null }, { at });")
    assert (said["word"], said["readings"]) == ("UNKNOWN", [])


@pytest.mark.parametrize(
    ("status", "reason", "way"),
    [
        ("ABORTED", "3.2 m from the path for 1 s", ": 3.2 m from the path for 1 s"),
        ("CANCELED", "canceled", ""),
        ("SUCCEEDED", None, ""),
    ],
)
def test_the_strip_tells_how_the_last_task_ended(
    page: Page, status: str, reason: str | None, way: str
) -> None:
    why = f'"{reason}"' if reason else "null"
    ended = f'{{ status: "{status}", reason: {why}, ended_at: "2026-01-02T03:03:00Z" }}'
    said = run(page, STRIP + f"return say({ended});")
    assert said["word"] == status
    assert re.fullmatch(r"At \d\d:\d\d:\d\d" + re.escape(way), said["way"])
    assert said["more"] == "500 m of 800 m in 3 min 0 s"


def test_holds_are_told_one_by_name_and_the_rest_by_number(page: Page) -> None:
    script = """
        const gate = { owner: "gate", reason: "the gate is shut" };
        return [[], [{ owner: "operator", reason: "" }], [gate, {}, {}]].map(heldWords);
    """
    said = run(page, STRIP + script)
    assert said == ["", "By operator", "By gate: the gate is shut, +2 more"]


def test_what_is_under_the_pointer_stays_there_when_one_zooms(page: Page) -> None:
    script = (
        "return [view, looks.zoomAt(view, 2.5, 100, 50)].map((v) => looks.toWorld(v, 100, 50));"
    )
    before, after = run(page, VIEW + script)
    assert after == pytest.approx(before)


def test_zooming_has_an_end_on_both_sides(page: Page) -> None:
    script = "return [1e9, 1e-9].map((factor) => looks.zoomAt(view, factor, 0, 0).scale);"
    assert run(page, VIEW + script) == [200, 0.01]


def test_a_fitted_view_shows_all_of_the_bounds_within_a_margin(page: Page) -> None:
    corners = "[{ x_m: -50, y_m: 10 }, { x_m: 150, y_m: 90 }]"
    script = f"""
        const fitted = looks.fitted(view, {{ minX: -50, minY: 10, maxX: 150, maxY: 90 }});
        return {corners}.map((corner) => looks.toScreen(fitted, corner));
    """
    (left, right) = run(page, VIEW + script)
    assert 20 < left["x"] < right["x"] < 580
    assert 20 < right["y"] < left["y"] < 380


def test_the_grid_has_round_steps_that_do_not_crowd(page: Page) -> None:
    steps = run(
        page,
        """
        const { roundStep } = await import("/web/js/map/grid.js");
        return [0.011, 0.1, 0.3, 1, 4.9, 5, 99, 1000].map(roundStep);
        """,
    )
    assert steps == pytest.approx([0.01, 0.1, 0.2, 1, 2, 5, 50, 1000])


def test_a_path_of_ten_thousand_points_is_drawn_in_less_than_8_ms(page: Page) -> None:
    milliseconds = run(
        page,
        VIEW
        + """
        const { PathShape } = await import("/web/js/map/path_shape.js");
        const { drawMoving, drawStill } = await import("/web/js/map/draw.js");
        const items = Array.from({ length: 10_000 }, (_, n) => {
          const turn = (n / 10_000) * 2 * Math.PI;
          return { x_m: 130 * Math.cos(turn), y_m: 90 * Math.sin(turn) + 8 * Math.sin(5 * turn) };
        });
        const path = new PathShape(items);
        const split = path.split(5000, items[5000]);
        const scene = { path, split, preview: null, runs: [], target: null, vehicle: null };
        const names = ["ground", "grid", "axis", "ahead", "done", "text", "quiet"];
        const colours = Object.fromEntries(names.map((name) => [name, "#888"]));
        const ink = { ...colours, font: "11px serif" };
        const canvas = Object.assign(document.createElement("canvas"), { width: 600, height: 400 });
        const context = canvas.getContext("2d", { alpha: false });
        const times = Array.from({ length: 30 }, () => {
          const begin = performance.now();
          drawStill(context, looks.fitted(view, path.bounds), ink, 1, scene);
          drawMoving(context, looks.fitted(view, path.bounds), ink, 1, scene);
          // To read a pixel waits until all is drawn.
          context.getImageData(0, 0, 1, 1);
          return performance.now() - begin;
        });
        return Math.min(...times);
        """,
    )
    assert milliseconds < 8


def test_a_pose_is_old_when_the_service_says_so_and_always_without_contact(page: Page) -> None:
    script = """
        const at = "2026-01-02T03:04:05.000Z";
        const vehicle = { at, pose: { x_m: 0, y_m: 0, yaw_rad: 0 } };
        const holds = { vehicle: { owner: "vehicle", since_at: at } };
        const age = (level, holds) => words.poseAge({ vehicle, holds }, { level });
        return [age("live", {}), age("live", holds), age("lost", {})];
    """
    fresh, old, lost = run(page, WORDS + script)
    # However long ago the last frame with a vehicle at rest was.
    assert fresh == ""
    assert old.startswith("no pose since ")
    assert lost.startswith("pose of ")


def test_the_side_of_the_path_is_said_in_words(page: Page) -> None:
    said = run(page, WORDS + "return [0.034, -1.2, 0.001, null].map(words.offPath);")
    assert said == ["0.03 m left", "1.20 m right", "0.00 m", "\u2013"]


def test_a_percentage_is_a_hundred_only_when_all_is_done(page: Page) -> None:
    assert run(page, WORDS + "return [0.9999, 1, 0.29].map(words.percent);") == [
        "99 %",
        "100 %",
        "29 %",
    ]


def test_the_map_is_told_in_words_to_those_who_do_not_see_it(page: Page) -> None:
    said = run(
        page,
        WORDS
        + f"""
        const pose = {{ x_m: 12.34, y_m: -4.5, yaw_rad: {math.pi / 2} }};
        const task = {{ id: "t1", progress: 0.62, target_index: 40, waypoint_count: 66 }};
        const vehicle = {{ pose, speed_mps: 2.8 }};
        return words.mapSentence({{ vehicle, task: {{ ...task, cross_track_error_m: 0.03 }} }}, "");
        """,
    )
    assert said == (
        "Vehicle at x 12.3 m, y -4.5 m, heading 90 degrees, 2.8 m/s. "
        "Task t1, 62 % done, waypoint 41 of 66, 0.03 m left of the path."
    )


UTM = {"x_m": 303_000.0, "y_m": 3_900_000.0}

DRAW = """
const { drawMoving, drawStill } = await import("/web/js/map/draw.js");
const { PathShape } = await import("/web/js/map/path_shape.js");
const { Trail } = await import("/web/js/map/trail.js");
const looks = await import("/web/js/map/view.js");
// The figures of the grid differ, so that they are drawn in the colour of the ground.
const hidden = Object.fromEntries(["grid", "axis", "quiet", "text"].map((name) => [name, "#fff"]));
const seen = { ahead: "#333", done: "#9cf", trail: "#00f", aim: "#808", vehicle: "#fa0" };
const ink = { ground: "#fff", outline: "#000", accent: "#06c", font: "11px sans-serif" };
const draw = (dx, dy, drift) => {
    const canvas = new OffscreenCanvas(600, 400);
    const at = (x, y) => ({ x_m: dx + x, y_m: dy + y, yaw_rad: 0.3 });
    const items = Array.from({ length: 80 }, (_, n) => at(n / 4, 3 * Math.sin(n / 8)));
    const path = new PathShape(items);
    const trail = new Trail();
    for (let n = 0; n < 20; n += 1) trail.add(at(n / 4, 0.2 + n / 16), 100 * n, "RUNNING");
    const pose = at(5.125, 1.5);
    const limits = { wheelbase_m: 1.75 };
    const vehicle = { pose, lookahead: at(8, 2), steering_angle_rad: 0.1, limits };
    const [split, target] = [path.split(21, pose), { place: path.waypoint(21), index: 21 }];
    const scene = { path, split, target, preview: null, runs: trail.runs, vehicle, isOld: false };
    const view = { ...looks.emptyView(), width: 600, height: 400, scale: 25 };
    const place = { x_m: dx + 8 + drift, y_m: dy + 1 };
    const context = canvas.getContext("2d");
    for (const drawPart of [drawStill, drawMoving])
        drawPart(context, looks.centred(view, place), { ...ink, ...seen, ...hidden }, 1, scene);
    return context.getImageData(0, 0, 600, 400).data;
};
const unlike = (one, other) => one.filter((value, at) => Math.abs(value - other[at]) > 24).length;
"""


@pytest.mark.parametrize("drift", [0.0, 0.013, 0.371])
def test_at_coordinates_of_utm_the_picture_is_the_same_as_at_the_origin(
    page: Page, drift: float
) -> None:
    script = f"""
        const [here, there] = [draw(0, 0, {drift}), draw({UTM["x_m"]}, {UTM["y_m"]}, {drift})];
        const blank = new Uint8ClampedArray(here.length).fill(255);
        return [unlike(here, there), unlike(here, blank)];
    """
    different, drawn = run(page, DRAW + script)
    assert drawn > 1000
    assert different == 0


def test_a_track_far_from_the_vehicle_is_shown_alone(page: Page) -> None:
    script = """
        const bounds = { minX: 303000, minY: 3900000, maxX: 303200, maxY: 3900100 };
        return [{ x_m: 0, y_m: 0 }, { x_m: 302500, y_m: 3900000 }].map((pose) =>
            looks.isFar(bounds, pose));
    """
    assert run(page, VIEW + script) == [True, False]
