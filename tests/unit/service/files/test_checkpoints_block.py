"""The block `checkpoints` of a node, as somebody writes it into a robot file."""

import pytest

from domain.errors import InvalidValueError
from domain.health.checkpoints import AliveLimits, CheckpointDeadline, CheckpointSettings
from domain.timebase import seconds
from service.files.robot_file import InvalidRobotFileError, read_robot_file, robot_settings_of
from tests.support.models import BASE, actuation_model

MODEL = actuation_model()


def settings_of(block: str) -> CheckpointSettings:
    """Return what a robot file means with a block of the drive base."""
    text = f"nodes:\n  drive_base:\n    checkpoints: {block}\n"
    return read_robot_file(text, MODEL).to_checkpoint_settings()[BASE]


def alive(block: str) -> AliveLimits:
    (limits,) = settings_of(f"{{alive: {{cycle: {block}}}}}").alive
    return limits


def fault(block: str) -> str:
    with pytest.raises(InvalidRobotFileError) as caught:
        settings_of(block)
    (found,) = caught.value.findings
    assert found.line == 3
    return found.message


def test_a_node_without_the_block_has_no_checkpoints() -> None:
    settings = read_robot_file("nodes: {drive_base: {on_return: restore}}", MODEL)

    assert settings.to_checkpoint_settings() == {}


def test_everything_that_can_be_supervised_is_read() -> None:
    settings = settings_of(
        "{alive: {cycle: {min_hz: 8, max_hz: 12, window_s: 2}},"
        " deadlines: {plan: {from: plan_begin, to: plan_end, within_s: 0.2}},"
        " order: {plan_begin: [plan_end], plan_end: [plan_begin, stop, stop]}, clear_for_s: 3}"
    )

    assert settings == CheckpointSettings(
        (AliveLimits("cycle", seconds(2), 16, 24),),
        (CheckpointDeadline("plan_begin", "plan_end", seconds(0.2)),),
        {"plan_begin": ("plan_end",), "plan_end": ("plan_begin", "stop")},
        seconds(3),
    )


@pytest.mark.parametrize(
    ("block", "at_least", "at_most"),
    [
        ("{min_hz: 8}", 8, None),
        ("{max_hz: 8}", 0, 8),
        ("{min_hz: 0.1}", 1, None),
        ("{min_hz: 0.5, max_hz: 0.9, window_s: 10}", 5, 9),
        ("{min_hz: 30, max_hz: 30, window_s: 0.7}", 21, 21),
        ("{min_hz: 7.5, max_hz: 8.5}", 8, 8),
    ],
)
def test_rates_are_numbers_of_times_in_the_window(
    block: str, at_least: int, at_most: int | None
) -> None:
    limits = alive(block)

    assert (limits.at_least, limits.at_most) == (at_least, at_most)


@pytest.mark.parametrize(
    ("block", "words"),
    [
        ("{}", "expected alive, deadlines or order"),
        ("{alive: {cycle: {}}}", "expected min_hz, max_hz or both"),
        ("{alive: {cycle: {max_hz: 0.5}}}", "a longer window is needed"),
        ("{alive: {cycle: {min_hz: 9, max_hz: 8}}}", "leave no number of times"),
        ("{alive: {cycle: {min_hz: 8.2, max_hz: 8.8}}}", "leave no number of times"),
        ("{alive: {cycle: {min_hz: 9000, window_s: 2}}}", "more than 10,000 times"),
        ("{alive: {cycle: {min_hz: 0}}}", "greater than 0"),
        ("{alive: {cycle: {min_hz: 8, rate: 9}}}", "unknown key"),
        ("{alive: {my cycle: {min_hz: 8}}}", "pattern"),
        ("{deadlines: {plan: {from: a, to: a, within_s: 1}}}", "from and to are the same"),
        ("{deadlines: {plan: {from: a, to: b}}}", "within_s"),
        ("{deadlines: {plan: {to: b, within_s: 1}}}", "from"),
        ("{order: {a: b}}", "list"),
    ],
)
def test_what_cannot_be_meant_is_told_with_its_place(block: str, words: str) -> None:
    assert words in fault(block)


def test_a_simulation_is_told_where_in_its_body_the_fault_is() -> None:
    block = {"deadlines": {"plan": {"from": "a", "to": "b", "within_s": -1}}}

    with pytest.raises(InvalidValueError) as caught:
        robot_settings_of({"nodes": {"drive_base": {"checkpoints": block}}}, MODEL)

    assert caught.value.pointer == "/nodes/drive_base/checkpoints/deadlines/plan/within_s"
