"""The parts of the timeline that count and do not draw, in the only engine that runs them."""

from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Page

pytestmark = pytest.mark.browser

LANES = """
const lanes = await import("/web/js/timeline/lanes.js");
const marks = await import("/web/js/timeline/marks.js");
const { emptyState } = await import("/web/js/base/store.js");
const T0 = Date.parse("2026-01-02T10:00:00.000Z");
const at = (s) => new Date(T0 + 1000 * s).toISOString();
let id = 0;
const event = (s, kind, data, more = {}) =>
  ({ id: ++id, at: at(s), kind, data, epoch: "one", cause: 1, actor: "", words: kind, ...more });
const group = (events = [], more = {}) => ({ events, from: T0, isFull: false, ...more });
const names = ["state", "task", "errors", "holds", "requests", "stops", "audit", "runs"];
const none = Object.fromEntries(names.map((name) => [name, group()]));
const groups = (given) => ({ ...none, ...given });
const record = (given, more = {}) =>
  ({ from: T0, groups: groups(given), dark: [], runBegin: T0 - 9e9, live: emptyState(), ...more });
const lane = (found, key) => found.find((one) => one.key === key);
const s = (time) => (time - T0) / 1000;
const times = ({ begin, end }) => [s(begin), end === Infinity ? null : s(end)];
const shown = ({ intervals }) => intervals.map((one) => [...times(one), one.short ?? one.text]);
const told = ({ unknown }) => unknown.map(times);
"""
RANDOM = """
let seed = SEED;
const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
const upTo = (n) => Math.floor(random() * n);
"""


def run(page: Page, script: str) -> Any:  # noqa: ANN401 - whatever the script returns
    return page.evaluate(f"async () => {{ {LANES} {script} }}")


def test_a_change_tells_also_what_was_before_it(page: Page) -> None:
    script = """
        const events = [
          event(10, "system_state.changed", { state: "RUNNING", was: "IDLE", errors: [] }),
          event(20, "system_state.changed", { state: "ERROR", was: "RUNNING", errors: ["ESTOP"] }),
        ];
        const found = lane(lanes.lanesOf(record({ state: group(events) }), []), "state");
        return [shown(found), told(found)];
    """
    intervals, unknown = run(page, script)
    assert intervals == [[0, 10, "IDLE"], [10, 20, "RUNNING"], [20, None, "ERROR"]]
    assert unknown == []


def test_without_an_event_it_was_all_the_time_as_it_is_now(page: Page) -> None:
    script = """
        const live = { ...emptyState(), systemState: { state: "IDLE", errors: [] } };
        const found = lanes.lanesOf(record({}, { live }), []);
        return [shown(lane(found, "state")), shown(lane(found, "task"))];
    """
    assert run(page, script) == [[[0, None, "IDLE"]], [[0, None, "no task"]]]


def test_nothing_is_carried_across_a_restart(page: Page) -> None:
    script = """
        const dark = [{ begin: T0 + 20_000, end: T0 + 50_000, isRestart: true }];
        const state = group([
          event(10, "system_state.changed", { state: "RUNNING", was: "IDLE", errors: [] }),
          event(55, "system_state.changed", { state: "IDLE", was: "ERROR", errors: [] }),
        ]);
        const errors = group([event(15, "error.raised", { error: "ESTOP", part: null })]);
        const found = lanes.lanesOf(record({ state, errors }, { dark }), []);
        return [shown(lane(found, "state")), shown(lane(found, "errors"))];
    """
    state, errors = run(page, script)
    assert state == [[0, 10, "IDLE"], [10, 20, "RUNNING"], [50, 55, "ERROR"], [55, None, "IDLE"]]
    assert errors == [[15, 20, "ESTOP"]]


def test_what_was_before_the_shown_time_tells_how_it_began_if_it_is_of_the_same_run(
    page: Page,
) -> None:
    script = """
        const dark = [{ begin: T0 + 20_000, end: T0 + 50_000, isRestart: true }];
        const live = { ...emptyState(), systemState: { state: "ERROR", errors: ["ESTOP"] } };
        const earlier = {
          state: group([event(-9, "system_state.changed", { state: "IDLE", was: "ERROR" })]),
          holds: group([event(-9, "hold.set", { owner: "a" }),
            event(-8, "hold.set", { owner: "b" }), event(-7, "hold.released", { owner: "b" })]),
        };
        return [T0 - 10_000, T0 - 1000].map((runBegin) => {
          const found = lanes.lanesOf(record(earlier, { dark, live, runBegin }), []);
          const state = lane(found, "state");
          return [shown(state), told(state), shown(lane(found, "holds"))];
        });
    """
    same_run, earlier_run = run(page, script)
    assert same_run == [[[0, 20, "IDLE"], [50, None, "ERROR"]], [], [[0, 20, "a"]]]
    assert earlier_run == [[[50, None, "ERROR"]], [[0, 20]], []]


def test_a_bar_whose_begin_was_not_seen_is_cut(page: Page) -> None:
    script = """
        const holds = group([event(30, "hold.released", { owner: "gate" })]);
        const live = emptyState();
        live.holds = { anna: { owner: "anna", reason: "", since_at: at(-60) } };
        const { intervals } = lane(lanes.lanesOf(record({ holds }, { live }), []), "holds");
        return intervals.map((one) => [one.short, ...times(one), one.cut]);
    """
    assert run(page, script) == [["gate", 0, 30, True], ["anna", 0, None, True]]


def test_errors_that_follow_from_others_have_no_bar(page: Page) -> None:
    script = """
        const errors = group([
          event(1, "error.raised", { error: "UNREACHABLE", part: "arm", root_cause: true }),
          event(1, "error.raised", { error: "STALE", part: "arm", root_cause: false }),
        ]);
        return shown(lane(lanes.lanesOf(record({ errors }), []), "errors"));
    """
    assert run(page, script) == [[1, None, "arm.UNREACHABLE"]]


def test_a_task_is_followed_from_its_acceptance_to_its_end(page: Page) -> None:
    script = """
        const task = (s, kind, reason) => event(s, `task.${kind}`, { task: "t1", reason });
        const why = "the gate is shut";
        const events = [task(1, "served"), task(2, "started"), task(5, "pausing", why),
          task(6, "paused", why), task(9, "resumed"), task(12, "aborted", "off path")];
        const found = lane(lanes.lanesOf(record({ task: group(events) }), []), "task");
        return shown(found);
    """
    assert run(page, script) == [
        [0, 1, "no task"],
        [1, 2, "t1 accepted"],
        [2, 5, "t1 running"],
        [5, 6, "t1 stopping"],
        [6, 9, "t1 paused"],
        [9, 12, "t1 running"],
        [12, 12, "t1 aborted"],
        [12, None, "no task"],
    ]


def test_a_command_says_who_asked_and_whether_it_was_rejected(page: Page) -> None:
    script = """
        const by = { cause: null, actor: "http:anna" };
        const hold = { owner: "gate", reason: "" };
        const asked = { ...by, words: "hold gate requested" };
        const requests = group([event(1, "hold.requested", hold, asked)]);
        const write = (s, method, path, status) =>
          event(s, "audit.write", { method, path, status, address: "" }, by);
        const audit = group([
          write(1, "PUT", "/holds/gate", 200),
          write(2, "POST", "/nodes/a/b/mode", 422),
          write(3, "PATCH", "/mock/battery_level", 200),
        ]);
        const { intervals } = lane(lanes.lanesOf(record({ requests, audit }), []), "commands");
        return intervals.map(({ text, who, tone }) => [text, who, tone]);
    """
    assert run(page, script) == [
        ["hold gate requested", "anna", "command"],
        ["rejected: mode of a/b", "anna", "rejected"],
        ["simulated battery_level set", "anna", "command"],
    ]


def test_modes_are_called_what_an_operator_calls_them(page: Page) -> None:
    script = """
        const changed = (s, actual, was) =>
          event(s, "part.actual_changed", { part: "arm", actual, was });
        const events = [changed(1, "active.FAST", "inactive"), changed(2, "unknown", "active")];
        const found = lanes.lanesOf(record({ "part:arm": group(events) }), ["arm"]);
        return lane(found, "part:arm").intervals.map(({ short, tone }) => [short, tone]);
    """
    assert run(page, script) == [["inactive", "rest"], ["active.FAST", "active"], ["?", "unknown"]]


@pytest.mark.parametrize("seed", range(1, 21))
def test_however_it_flaps_the_lane_is_what_a_naive_look_at_each_moment_says(
    page: Page, seed: int
) -> None:
    script = (
        RANDOM.replace("SEED", str(seed))
        + """
        const states = ["IDLE", "RUNNING", "ERROR"];
        const [dark, events] = [[], []];
        let [now, is] = [0, "IDLE"];
        for (let n = 0; n < 200; n += 1) {
          now += upTo(4);
          if (upTo(20) === 0) {
            const begin = now;
            now += 1 + upTo(5);
            dark.push({ begin: T0 + 1000 * begin, end: T0 + 1000 * now });
            is = states[upTo(3)];
          }
          const state = states[upTo(3)];
          events.push(event(now, "system_state.changed", { state, was: is, errors: [] }));
          is = state;
        }
        const found = lane(lanes.lanesOf(record({ state: group(events) }, { dark }), []), "state");
        const naive = (time) => {
          if (dark.some(({ begin, end }) => begin < time && time < end)) return null;
          const edge = Math.max(T0, ...dark.map(({ end }) => end).filter((end) => end < time));
          const last = events.findLast(({ at }) => Date.parse(at) < time);
          if (last && Date.parse(last.at) >= edge) return last.data.state;
          return events.find(({ at }) => Date.parse(at) > time)?.data.was ?? "none";
        };
        const wrong = [];
        for (let half = 1; half < 2 * now; half += 2) {
          const time = T0 + 500 * half;
          const is = found.intervals.filter(({ begin, end }) => begin < time && time < end);
          const said = is.length ? is.map(({ short }) => short).join() : null;
          if (said !== naive(time)) wrong.push([half / 2, said, naive(time)]);
        }
        return wrong;
    """
    )
    assert run(page, script) == []


@pytest.mark.parametrize("seed", range(1, 21))
def test_no_interval_is_lost_however_many_share_a_pixel(page: Page, seed: int) -> None:
    script = (
        RANDOM.replace("SEED", str(seed))
        + """
        const intervals = [];
        for (let n = 0; n < 500; n += 1) {
          const begin = upTo(100_000);
          const end = begin + (upTo(3) ? upTo(50) : upTo(20_000));
          intervals.push({ begin, end, tone: ["rest", "warn", "alarm"][upTo(3)], n });
        }
        intervals.sort((a, b) => a.begin - b.begin);
        const scale = { from: 20_000, to: 70_000, width: 50 + upTo(600) };
        const seen = intervals.filter(({ begin, end }) => end >= scale.from && begin <= scale.to);
        const rows = marks.rowsOf(seen, 3).map((row) => marks.marksOf(row, scale));
        const drawn = rows.flat();
        const found = drawn.flatMap(({ items }) => items.map(({ n }) => n));
        const worst = (items) => (items.some(({ tone }) => tone === "alarm") ? "alarm"
          : items.some(({ tone }) => tone === "warn") ? "warn" : "rest");
        return {
          rows: rows.length,
          all: found.length === seen.length && new Set(found).size === seen.length,
          wide: drawn.every(({ x0, x1 }) => x1 - x0 >= 2),
          apart: rows.every((row) => row.every(({ x0 }, n) => n === 0 || x0 >= row[n - 1].x1)),
          near: drawn.every(({ x0, x1, items }) => items.every(({ begin, end }) =>
            marks.xOf(scale, Math.max(begin, scale.from)) >= x0 - 3.5 &&
            marks.xOf(scale, Math.min(end, scale.to)) <= x1 + 0.5)),
          tones: drawn.every(({ tone, items }) => tone === worst(items)),
        };
    """
    )
    found = run(page, script)
    assert found == {
        "rows": 3, "all": True, "wide": True, "apart": True, "near": True, "tones": True,
    }  # fmt: skip


def test_the_worst_of_what_shares_a_mark_gives_its_colour(page: Page) -> None:
    script = """
        const tones = ["rest", "alarm", "rest"];
        const items = tones.map((tone, n) => ({ begin: n, end: n + 1, tone }));
        const [mark] = marks.marksOf(items, { from: 0, to: 100_000, width: 100 });
        return [mark.tone, mark.items.length];
    """
    assert run(page, script) == ["alarm", 3]


def test_labels_of_the_axis_have_room_and_round_times(page: Page) -> None:
    script = """
        return [[60, 600], [600, 600], [86_400, 600], [600, 240]].map(([seconds, width]) => {
          const { ticks, step } = marks.ticksOf({ from: T0, to: T0 + 1000 * seconds, width });
          const px = (step / (1000 * seconds)) * width;
          const isRound = ticks.every((at) => (at + 0) % Math.min(step, 3_600_000) === 0);
          return [step / 1000, ticks.length, px >= 64, isRound];
        });
    """
    for step, count, has_room, is_round in run(page, script):
        assert has_room, step
        assert is_round, step
        assert count <= 9


def test_following_now_moves_by_whole_pixels(page: Page) -> None:
    script = """
        const { scaleOf, SPANS } = await import("/web/js/timeline/range.js");
        const range = { span: 600_000, end: null };
        const ends = Array.from({ length: 40 }, (_, n) => scaleOf(range, T0 + 100 * n, 600).to);
        return new Set(ends).size;
    """
    assert run(page, script) in (4, 5)


def test_zooming_keeps_now_or_what_is_under_the_pointer(page: Page) -> None:
    script = """
        const { scaleOf, zoomed, moved } = await import("/web/js/timeline/range.js");
        const [now, width] = [T0, 600];
        const live = zoomed({ span: 600_000, end: null }, 2, 0.3, now);
        const past = moved({ span: 600_000, end: null }, -900_000, now);
        const place = (range, x) => marks.timeAt(scaleOf(range, now, width), x);
        const [before, after] = [past, zoomed(past, 3, 0.25, now)].map((one) => place(one, 150));
        const far = moved(past, -1e12, now);
        return [live, Math.abs(before - after) < 1, (now - far.end + far.span) / 3_600_000,
          moved(past, 1e12, now).end, ...[1e9, 1e-9].map((by) => zoomed(past, by, 0, now).span)];
    """
    live, is_kept, far_h, back, least, most = run(page, script)
    assert live == {"span": 300_000, "end": None}
    assert is_kept
    assert far_h == pytest.approx(24)
    assert back is None
    assert (least, most) == (10_000, 24 * 3_600_000)


def test_a_chain_of_causes_is_told_from_the_near_to_the_far(page: Page) -> None:
    script = """
        const { causeWords } = await import("/web/js/timeline/causes.js");
        const one = (words, cause, actor = "") => ({ words, cause, actor, at: at(0) });
        const first = one("hold requested", null, "http:anna");
        const chain = [one("task paused", 2), one("hold set", 1), first];
        const words = causeWords(chain).replaceAll(/\\d\\d:\\d\\d:\\d\\d/g, "T");
        return [words, causeWords(chain.slice(0, 1))];
    """
    assert run(page, script) == [
        "because of hold set at T, because of hold requested at T by anna",
        "The cause is no longer kept.",
    ]


def test_a_small_robot_has_a_lane_for_each_part_and_a_large_one_for_those_that_are_chosen(
    page: Page,
) -> None:
    script = """
        const { chosenParts } = await import("/web/js/timeline/chosen_parts.js");
        const robot = (count) => Object.fromEntries(Array.from({ length: count }, (_, n) =>
          [`n${n}`, { name: `n${n}`, kind: n === 2 ? "system" : "node" }]));
        const kept = ["n0", "n2", "gone"];
        const chosen = [3, 90].map((count) => chosenParts(robot(count), "n1", kept));
        return chosen.map(({ names }) => names);
    """
    assert run(page, script) == [["n2", "n0", "n1"], ["n2", "n1", "n0"]]
