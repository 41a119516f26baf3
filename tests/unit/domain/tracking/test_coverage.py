import hypothesis.strategies as st
import pytest
from hypothesis import given

from domain.tracking.coverage import MAX_TRAIL, STEP_M, Coverage
from domain.vehicle import Pose, VehicleState
from tests.support.paths import straight


def at(x_m: float, y_m: float = 0.0, speed_mps: float = 2.8) -> VehicleState:
    return VehicleState(Pose(x_m, y_m, 0.0), speed_mps, 0.0)


@pytest.fixture
def coverage() -> Coverage:
    return Coverage(straight(60.0), 0.0, 0.0, near_m=3.0, braking_mps2=1.0)


def test_a_vehicle_on_its_path_leaves_nothing_out(coverage: Coverage) -> None:
    for x_m in range(40):
        coverage.note(at(x_m), float(x_m))

    assert (coverage.reached_m, coverage.left_out_m) == (39.0, 0.0)


def test_what_is_jumped_over_is_left_out(coverage: Coverage) -> None:
    coverage.note(at(20.0), 20.0)

    assert coverage.left_out_m == pytest.approx(17.0)


def test_what_a_vehicle_rolls_over_while_nothing_is_heard_of_it_is_driven(
    coverage: Coverage,
) -> None:
    """From 5 m/s, without commands for 0.5 s and then braking at 1 m/s2: 15 m."""
    coverage.note(at(0.0, speed_mps=5.0), 0.0)
    coverage.note(at(14.9, speed_mps=0.0), 14.9)

    assert (coverage.reached_m, coverage.left_out_m) == (14.9, 0.0)


def test_what_a_vehicle_was_carried_over_is_left_out(coverage: Coverage) -> None:
    coverage.note(at(0.0, speed_mps=5.0), 0.0)
    coverage.note(at(15.1, speed_mps=0.0), 15.1)

    assert coverage.left_out_m == pytest.approx(15.1 - 2 * 3.0, abs=0.3)


def test_what_was_passed_before_it_was_judged_counts(coverage: Coverage) -> None:
    """An approach drives beside the path before it is on it."""
    for x_m in range(20):
        coverage.note(at(x_m, 2.5), None)
    assert coverage.reached_m == 0.0
    coverage.note(at(20.0), 20.0)

    assert (coverage.reached_m, coverage.left_out_m) == (20.0, 0.0)


def test_what_was_passed_too_far_beside_does_not(coverage: Coverage) -> None:
    for x_m in range(20):
        coverage.note(at(x_m, 3.5), None)
    coverage.note(at(20.0), 20.0)

    assert coverage.left_out_m == pytest.approx(17.0)


def test_a_trail_of_any_length_takes_bounded_memory(coverage: Coverage) -> None:
    for number in range(3 * MAX_TRAIL):
        coverage.note(at(float(number), 10.0), None)

    assert len(coverage._trail) <= MAX_TRAIL  # noqa: SLF001 - its memory is what is bounded


@given(
    st.lists(st.tuples(st.floats(0, 60), st.floats(-8, 8)), max_size=8),
    st.tuples(st.floats(0, 60), st.floats(-3, 3)),
)
def test_the_lower_bound_of_what_was_left_out_is_one(
    places: list[tuple[float, float]], here: tuple[float, float]
) -> None:
    coverage = Coverage(straight(60.0), 0.0, 0.0, near_m=3.0, braking_mps2=1.0)
    for x_m, y_m in places:
        coverage.note(at(x_m, y_m, 0.0), None)
    bound_m = coverage.least_missed_m(at(*here, 0.0))
    coverage.note(at(*here, 0.0), None)

    # Pieces of the path are judged by their middles.
    assert bound_m <= coverage.missed_m(here[0]) + STEP_M


def test_of_a_jump_the_lower_bound_is_what_is_left_out(coverage: Coverage) -> None:
    coverage.note(at(0.0), 0.0)

    assert coverage.least_missed_m(at(40.0)) == pytest.approx(40.0 - 2 * 3.0)
    assert coverage.least_missed_m(at(2.0)) == 0.0, "it may have rolled there"


def test_what_a_vehicle_may_have_driven_since_it_was_seen_last_counts_as_rolled(
    coverage: Coverage,
) -> None:
    """At 5 m/s for 1 s until it is unheard, 0.5 s more, and then braking at 1 m/s2: 20 m."""
    coverage.go_on_from(at(0.0, speed_mps=5.0), unseen_s=1.0)

    assert coverage.may_have_rolled(at(20.0))
    assert not coverage.may_have_rolled(at(20.1))


def test_once_it_is_seen_again_only_what_is_unheard_counts(coverage: Coverage) -> None:
    coverage.go_on_from(at(0.0, speed_mps=5.0), unseen_s=1.0)
    coverage.note(at(20.0, speed_mps=0.0), 20.0)

    assert (coverage.reached_m, coverage.left_out_m) == (20.0, 0.0)
    assert not coverage.may_have_rolled(at(20.1))
