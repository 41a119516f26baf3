import pytest

from api.cli.task_text import distance_text, progress_text, status_text
from tests.support.monitor import task


def test_progress_has_a_bar_the_distance_the_speed_and_the_error() -> None:
    assert progress_text(task(), 2.81) == (
        "[######.........]  42% 336.0 of 800.0 m  2.8 m/s  +0.03 m off  running"
    )


def test_a_task_that_waits_shows_its_reason_instead_of_the_speed() -> None:
    held = task("PAUSED", reason="e-stop is pressed")

    assert progress_text(held, 0.0) == (
        "[######.........]  42% 336.0 of 800.0 m  paused: e-stop is pressed"
    )


def test_an_unknown_speed_is_a_question_mark_and_an_unknown_error_is_left_out() -> None:
    assert progress_text(task(cross_track_error_m=None), None).endswith("m  ? m/s  running")


def test_the_distance_is_that_traveled_and_that_of_the_whole_path() -> None:
    assert distance_text(task()) == "336.0 of 800.0 m"


@pytest.mark.parametrize(
    ("status", "reason", "text"),
    [
        ("RUNNING", None, "running"),
        ("CANCELED", "canceled", "canceled"),
        ("ABORTED", "no progress for 20 s", "aborted: no progress for 20 s"),
    ],
)
def test_a_status_has_its_reason_unless_that_says_the_same(
    status: str, reason: str | None, text: str
) -> None:
    assert status_text(task(status, reason=reason)) == text
