from domain.plans.durations import MOST_KEPT, Durations
from domain.state_and_mode import PartName
from domain.timebase import seconds

ARM = PartName("arm")


def test_a_step_that_was_never_done_has_no_expected_time() -> None:
    assert Durations().expected(ARM, "activate") is None


def test_the_expected_time_is_the_median_of_the_same_node_and_action() -> None:
    durations = Durations()
    for took in (1.0, 9.0, 2.0):
        durations.note(ARM, "activate", seconds(took))
    durations.note(ARM, "configure", seconds(7))
    durations.note(PartName("base"), "activate", seconds(7))
    assert durations.expected(ARM, "activate") == seconds(2)


def test_only_the_last_times_count() -> None:
    durations = Durations()
    for took in [100.0] * MOST_KEPT + [1.0] * MOST_KEPT:
        durations.note(ARM, "activate", seconds(took))
    assert durations.expected(ARM, "activate") == seconds(1)
