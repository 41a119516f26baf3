from math import pi, sqrt, tan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from domain.paths.path import Path
from domain.paths.speed_profile import (
    BRAKING_SHARE,
    CRAWL_MPS,
    LATERAL_SHARE,
    REACTION_S,
    STEP_M,
    STRETCH_STEPS,
    TURNING_MPS,
    SpeedLimits,
    SpeedProfile,
)
from domain.vehicle import VehicleLimits

LIMITS = SpeedLimits()
VEHICLE = VehicleLimits()


def line(length: float) -> Path:
    return Path(np.array([[0.0, 0.0, 0.0], [length, 0.0, 0.0]]))


def bend_between_straights(radius: float) -> Path:
    """Return 50 m straight on, half a circle to the left, and 50 m back."""
    turn = np.linspace(0, pi, 200)
    bend = np.column_stack((50 + radius * np.sin(turn), radius - radius * np.cos(turn), turn))
    return Path(np.vstack(([0.0, 0.0, 0.0], bend, [0.0, 2 * radius, pi])))


def profile(path: Path, cruise: float = 2.8, limits: SpeedLimits = LIMITS) -> SpeedProfile:
    return SpeedProfile(path, cruise, limits, VEHICLE)


def stopping_distance(speed: float) -> float:
    """Return how far a vehicle goes that hears late and brakes as planned, m."""
    return REACTION_S * speed + speed**2 / (2 * BRAKING_SHARE * LIMITS.braking_mps2)


def test_on_a_straight_it_cruises() -> None:
    assert profile(line(100)).speed_at(0.0) == 2.8
    assert profile(line(100)).speed_at(50.0) == 2.8


def test_no_cruise_is_faster_than_the_vehicle() -> None:
    assert profile(line(500), 50.0).speed_at(100.0) == pytest.approx(VEHICLE.max_speed_mps)


def test_it_brakes_to_stand_at_the_end() -> None:
    speeds = profile(line(100))

    for left in (0.2, 1.0, 3.0):
        speed = speeds.speed_at(100 - left)
        assert stopping_distance(speed) == pytest.approx(left)
    assert speeds.speed_at(100.0) == 0.0
    assert speeds.speed_at(101.0) == 0.0


def test_before_the_end_it_never_stops() -> None:
    assert profile(line(100)).speed_at(100 - 1e-9) == CRAWL_MPS


def test_who_cruises_slower_than_a_crawl_crawls_no_faster() -> None:
    assert profile(line(10), 0.02).speed_at(9.999) == pytest.approx(0.02)


@pytest.mark.parametrize("length", [0.01, 0.3, 5.0, 7.3])
def test_a_path_too_short_for_the_cruise_is_braked_on_from_its_start(length: float) -> None:
    speed = profile(line(length), 7.0).speed_at(0.0)

    assert stopping_distance(speed) == pytest.approx(length) or speed == CRAWL_MPS


def test_in_a_bend_the_lateral_acceleration_is_kept() -> None:
    speeds = profile(bend_between_straights(10.0), 7.0)

    assert speeds.speed_at(50 + 5 * pi) == pytest.approx(sqrt(LATERAL_SHARE * 2 * 10), rel=0.01)


def test_a_bend_is_braked_for_in_time() -> None:
    path = bend_between_straights(10.0)
    speeds = profile(path, 7.0)

    assert speeds.speed_at(50 - 25) == pytest.approx(7.0)
    assert speeds.speed_at(50 - 10) < 7.0
    assert speeds.speed_at(50) == pytest.approx(sqrt(LATERAL_SHARE * 2 * 10), abs=0.5)


def test_a_corner_of_a_polygon_is_driven_as_the_tightest_bend() -> None:
    corner = Path(np.array([[0.0, 0.0, 0.0], [50.0, 0.0, 0.0], [50.0, 50.0, 0.0]]))
    tightest = tan(VEHICLE.max_steering_angle_rad) / VEHICLE.wheelbase_m

    assert profile(corner, 7.0).speed_at(50.0) == pytest.approx(
        sqrt(LATERAL_SHARE * 2 / tightest), rel=0.05
    )


@given(
    st.lists(st.tuples(st.floats(-40, 40), st.floats(-40, 40)), min_size=2, max_size=12).filter(
        lambda places: max(abs(x - places[0][0]) for x, _ in places) > 1
    ),
    st.floats(0.5, 8.0),
    st.floats(0.3, 3.0),
)
def test_it_never_asks_for_more_braking_than_allowed(
    places: list[tuple[float, float]], cruise: float, braking: float
) -> None:
    path = Path(np.array([(x, y, 0.0) for x, y in places]))
    speeds = profile(path, cruise, SpeedLimits(braking_mps2=braking))
    at = np.linspace(0, path.length_m, 400)
    squares = np.array([speeds.speed_at(distance) ** 2 for distance in at])

    fallen = squares[:-1] - squares[1:]
    assert (fallen <= 2 * braking * np.diff(at) + CRAWL_MPS**2 + 1e-9).all()
    assert squares.max() <= cruise**2 + 1e-9


# --- slow front wheels ---------------------------------------------------------------------------


def slowest(path: Path, vehicle: VehicleLimits) -> float:
    return SpeedProfile(path, 7.0, LIMITS, vehicle).slowest_mps


def test_slow_wheels_slow_a_corner_down() -> None:
    corner = Path(np.array([[0.0, 0.0, 0.0], [50.0, 0.0, 0.0], [50.0, 50.0, 0.0]]))
    quick, slow = VehicleLimits(), VehicleLimits(steering_rate_radps=0.3)

    assert slowest(corner, slow) < 0.6 * slowest(corner, quick)


def test_late_wheels_slow_a_corner_down() -> None:
    corner = Path(np.array([[0.0, 0.0, 0.0], [50.0, 0.0, 0.0], [50.0, 50.0, 0.0]]))

    assert slowest(corner, VehicleLimits(steering_delay_s=0.5)) < slowest(corner, VEHICLE)


def test_slow_wheels_do_not_slow_a_straight_with_the_noise_of_a_recording() -> None:
    x = np.arange(0.0, 100.0, 0.5)
    noise = np.random.default_rng(3).normal(0.0, 0.005, len(x))
    line = Path(np.column_stack((x, noise, np.zeros_like(x))))

    assert slowest(line, VehicleLimits(steering_rate_radps=0.11)) == pytest.approx(
        slowest(line, VEHICLE)
    )


def test_however_slow_the_wheels_it_goes_on() -> None:
    corner = Path(np.array([[0.0, 0.0, 0.0], [50.0, 0.0, 0.0], [50.0, 50.0, 0.0]]))

    assert slowest(corner, VehicleLimits(steering_rate_radps=1e-6)) == pytest.approx(TURNING_MPS)


def test_who_brakes_weakly_brakes_earlier() -> None:
    weak = SpeedProfile(line(100), 5.0, LIMITS, VehicleLimits(braking_mps2=0.2))

    assert weak.speed_at(90.0) == pytest.approx(sqrt(2 * BRAKING_SHARE * 0.2 * 10), abs=0.1)


def test_a_goal_on_a_path_of_any_length_begins_at_the_cost_of_a_short_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Planning 100,000 waypoints at once would hold up the loop for 0.2 s."""
    samples: list[int] = []
    curvatures_at = Path.curvatures_at

    def counted(path: Path, distances_m: NDArray[np.float64]) -> NDArray[np.float64]:
        samples.append(len(distances_m))
        return curvatures_at(path, distances_m)

    monkeypatch.setattr(Path, "curvatures_at", counted)
    speeds = profile(line(100_000.0), 11.0)
    for distance_m in np.linspace(49_000.0, 51_000.0, 2_000).tolist():
        speeds.speed_at(distance_m)

    # 11 m/s are braked within 76 m.
    assert max(samples) <= STRETCH_STEPS + 2 * 76 + 2 * 8 + 3
    assert len(samples) <= 2_000 / (STRETCH_STEPS * STEP_M) + 2


def test_a_stretch_brakes_for_what_the_next_one_demands() -> None:
    """A bend just beyond the end of the first stretch of 250 m."""
    bend = bend_between_straights(10.0).waypoints + np.array([205.0, 0.0, 0.0])
    speeds = profile(Path(np.vstack(([0.0, 0.0, 0.0], bend))), 7.0)

    assert speeds.speed_at(STRETCH_STEPS * STEP_M - 1.0) < 7.0
    begin = np.linspace(200.0, 270.0, 500)
    allowed = np.array([speeds.speed_at(distance) for distance in begin.tolist()])
    braking = -np.diff(allowed**2) / np.diff(begin) / 2
    assert braking.max() <= BRAKING_SHARE + 1e-6
