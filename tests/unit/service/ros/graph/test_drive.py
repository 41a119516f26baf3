import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from domain.timebase import seconds
from domain.vehicle import COMMAND_VALID_FOR, DriveCommand
from service.ros.graph.drive import REPEAT_EVERY, REPEATS, Deadman, drive_message

HALF_S = COMMAND_VALID_FOR


@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_speed_0_is_due_half_a_second_after_the_command_was_sent(speed: float) -> None:
    deadman = Deadman()
    deadman.take(DriveCommand(speed, 0.2), sent_at=100)

    assert deadman.wake_at() == 100 + HALF_S
    assert deadman.advance(100 + HALF_S - 1) is None
    assert deadman.advance(100 + HALF_S) == DriveCommand(0.0, 0.2)


def test_speed_0_is_repeated_for_2_s() -> None:
    deadman = Deadman()
    deadman.take(DriveCommand(1.0, 0.0), sent_at=0)
    stops = 0
    while (due := deadman.wake_at()) is not None:
        assert deadman.advance(due) == DriveCommand(0.0, 0.0)
        stops += 1

    assert stops == REPEATS == seconds(2.0) // REPEAT_EVERY


def test_who_is_told_to_stand_is_told_nothing_more() -> None:
    deadman = Deadman()
    deadman.take(DriveCommand(1.0, 0.0), sent_at=0)
    deadman.take(DriveCommand(0.0, 0.0), sent_at=1)

    assert deadman.wake_at() is None
    assert deadman.advance(10 * HALF_S) is None


@given(st.lists(st.tuples(st.integers(0, 10**9), st.sampled_from([0.0, 1.0, -2.0])), max_size=30))
def test_whenever_commands_come_nothing_is_driven_longer_than_half_a_second(
    commands: list[tuple[int, float]],
) -> None:
    deadman, now, speed, since = Deadman(), 0, 0.0, 0
    for after, told in [*commands, (10**9, 0.0)]:
        end = now + after
        while (due := deadman.wake_at()) is not None and due <= end:
            stop = deadman.advance(due)
            assert stop is not None
            assert stop.speed_mps == 0.0
            assert not speed or due - since == HALF_S
            speed = 0.0
        assert not speed or end - since < HALF_S
        now, speed, since = end, told, end
        deadman.take(DriveCommand(told, 0.0), now)


def test_a_twist_turns_as_the_wheels_do() -> None:
    message = drive_message(DriveCommand(2.0, 0.3), "geometry_msgs/msg/Twist", 2.0)

    assert message == {"linear": {"x": 2.0}, "angular": {"z": math.tan(0.3)}}
