"""Signals that a robot file declares: read or computed, with limits for all modes or by mode."""

import pytest

from domain.health.signals import ModeLimit, SignalSettings
from domain.state_and_mode import ModeName, PartName
from domain.timebase import seconds
from domain.windows.settings import Statistic, Threshold, WindowSettings
from service.files.robot_file import InvalidRobotFileError, read_robot_file
from tests.support.models import actuation_model
from tests.support.watched_robot import above

MODEL = actuation_model()


def signals(text: str) -> dict[str, SignalSettings]:
    settings = read_robot_file(f"signals:\n{text}", MODEL).to_signal_settings()
    return {item.spec.name: item for item in settings}


def findings(text: str) -> list[tuple[int | None, int | None, str, str]]:
    with pytest.raises(InvalidRobotFileError) as caught:
        read_robot_file(f"signals:\n{text}", MODEL)
    return [(f.line, f.column, f.code, f.message) for f in caught.value.findings]


def test_a_monitor_is_declared_with_its_window() -> None:
    scan = signals(
        "  scan: {}\n"
        "  scan_rate: {of: scan, statistic: rate, window_s: 5, below: 8, error: SCAN_SLOW,\n"
        "    part: drive_base, severity: urgent}\n"
    )["scan_rate"]
    assert scan.monitor is not None
    assert scan.monitor.of == "scan"
    assert scan.monitor.window == WindowSettings(statistic=Statistic.RATE, length=seconds(5))
    assert (scan.stale_after, scan.spec.unit) == (0, "Hz")
    assert [error.key.name for error in scan.can_raise().values()] == ["drive_base.SCAN_SLOW"]


def test_each_statistic_has_its_own_keys() -> None:
    told = signals(
        "  high: {of: /battery_level, statistic: percentile, q: 90, window_n: 50, min_n: 10}\n"
        "  left: {of: battery_level, statistic: time_to_limit, window_s: 60, limit: {below: 0.2},\n"
        "    min_r2: 0.8}\n"
        "  last: {of: battery_level, statistic: age, window_n: 1}\n"
    )
    windows = {name: item.monitor.window for name, item in told.items() if item.monitor}
    assert windows["high"] == WindowSettings(
        statistic=Statistic.PERCENTILE, size=50, min_n=10, q=90.0
    )
    assert windows["left"] == WindowSettings(
        statistic=Statistic.TIME_TO_LIMIT,
        length=seconds(60),
        limit=Threshold(0.2, above=False),
        min_r2=0.8,
    )
    assert windows["last"].min_n == 1, "no more than the window holds"


def test_the_unit_of_a_monitor_follows_from_its_signal() -> None:
    told = signals(
        "  motor: {unit: A}\n"
        "  mean: {of: motor, statistic: mean, window_s: 5}\n"
        "  peak: {of: mean, statistic: max, window_s: 5}\n"
        "  trend: {of: mean, statistic: slope, window_s: 5}\n"
        "  silent: {of: motor, statistic: gap, window_s: 5}\n"
        "  named: {of: motor, statistic: gap, window_s: 5, unit: secs}\n"
        "  warmth: {of: temperature, statistic: mean, window_s: 5}\n"
    )
    units = {name: item.spec.unit for name, item in told.items() if item.monitor}
    assert units == {
        "mean": "A",
        "peak": "A",
        "trend": "A/s",
        "silent": "s",
        "named": "secs",
        "warmth": "°C",
    }


def test_a_monitor_is_never_stale_whatever_is_said_of_all_signals() -> None:
    told = signals("  stale_after_s: 9\n  mean: {of: temperature, statistic: mean, window_s: 5}\n")
    assert (told["mean"].stale_after, told["temperature"].stale_after) == (0, seconds(9))


def test_limits_may_differ_by_mode() -> None:
    load = signals(
        "  load: {error: HIGH, for_s: 3, limits: {drive_base.FAST: {above: 60, for_s: 1},\n"
        "    default: {above: 80}}}\n"
    )["load"]
    assert load.bounds == ()
    assert load.limits == (
        ModeLimit(above(60, for_s=1), PartName("drive_base"), ModeName("FAST")),
        ModeLimit(above(80, for_s=3)),
    )


MEAN = "of: temperature, statistic: mean"


@pytest.mark.parametrize(
    ("text", "place", "code", "words"),
    [
        ("  a: {of: temperature}", (2, 7), "INVALID_VALUE", "needs a statistic"),
        ("  a: {statistic: mean}", (2, 7), "INVALID_VALUE", "which have `of`"),
        ("  a: {window_s: 5}", (2, 7), "INVALID_VALUE", "which have `of`"),
        (f"  a: {{{MEAN}}}", (2, 3), "INVALID_VALUE", "window_s or window_n"),
        (f"  a: {{{MEAN}, window_s: 1, window_n: 1}}", (2, 41), "INVALID_VALUE", "either"),
        (f"  a: {{{MEAN}, window_s: 0}}", (2, 41), "INVALID_VALUE", "greater than 0"),
        (f"  a: {{{MEAN}, window_n: 100001}}", (2, 41), "INVALID_VALUE", "100,000"),
        (f"  a: {{{MEAN}, window_s: 1, q: 5}}", (2, 54), "INVALID_VALUE", "percentile only"),
        (f"  a: {{{MEAN}, window_s: 1, minimum: 5}}", (2, 54), "INVALID_VALUE", "computed"),
        (f"  a: {{{MEAN}, window_s: 1, stale_after_s: 5}}", (2, 54), "INVALID_VALUE", "read"),
        ("  a: {of: b, statistic: mode, window_s: 1}", (2, 14), "INVALID_VALUE", "'mean'"),
        ("  a: {of: b, statistic: mean, window_s: 1}", (2, 7), "UNKNOWN_SIGNAL", "no signal 'b'"),
        ("  a: {of: a, statistic: mean, window_s: 1}", (2, 7), "MONITOR_CYCLE", "itself"),
        (
            "  b: {of: temperature, statistic: gap, window_s: 1}\n"
            "  a: {of: b, statistic: mean, window_s: 1}",
            (3, 7),
            "NOT_CHAINABLE",
            "b is the gap of a signal",
        ),
        (
            "  a: {of: signal_strength, statistic: mean, window_s: 1}",
            (2, 28),
            "WRONG_TYPE",
            "no number",
        ),
        (
            "  a: {of: b, statistic: max, window_s: 36000}\n"
            "  b: {source: {os: {what: cpu_percent, period_s: 0.2}}}",
            (2, 30),
            "WINDOW_TOO_LARGE",
            "180,000 readings; 100,000",
        ),
        ("  a: {error: A}", (2, 3), "INVALID_VALUE", "requires above, below or limits"),
        ("  a: {above: 1}", (2, 3), "INVALID_VALUE", "requires error"),
        ("  a: {error: A, above: 1, below: 0}", (2, 3), "INVALID_VALUE", "mutually exclusive"),
        (
            "  a: {error: A, above: 1, limits: {default: {above: 1}}}",
            (2, 3),
            "INVALID_VALUE",
            "write them as its default",
        ),
        ("  a: {error: A, limits: {}}", (2, 17), "INVALID_VALUE", "at least 1"),
        (
            "  a: {error: A, limits: {drive_bse.FAST: {above: 1}}}",
            (2, 26),
            "UNKNOWN_PART",
            "did you mean drive_base?",
        ),
        (
            "  a: {error: A, limits: {drive_base.FASTER: {above: 1}}}",
            (2, 26),
            "UNKNOWN_MODE",
            "no mode 'FASTER'; it is one of __DEFAULT__, SLOW, FAST",
        ),
        (
            "  a: {error: A, limits: {drive_base: {above: 1}}}",
            (2, 26),
            "UNKNOWN_MODE",
            "name a mode",
        ),
        (
            "  a: {error: A, maximum: 5, limits: {default: {above: 9}}}",
            (2, 3),
            "INVALID_VALUE",
            "can never be reached",
        ),
    ],
)
def test_what_does_not_fit_is_found_at_its_place(
    text: str, place: tuple[int, int], code: str, words: str
) -> None:
    ((line, column, found, message),) = findings(text + "\n")
    assert ((line, column), found) == (place, code), message
    assert words in message
