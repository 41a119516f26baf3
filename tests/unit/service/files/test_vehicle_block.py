import json
from typing import Any

import pytest
from pydantic import ValidationError

from domain.vehicle import VehicleLimits
from service.files.vehicle_block import VehicleBlock

EVERYTHING: dict[str, Any] = {
    "wheelbase_m": 2.5,
    "max_steering_angle_rad": 0.5,
    "max_speed_mps": 6.5,
    "pose": {"x_m": 1.5, "y_m": -2.5, "yaw_rad": 0.75},
    "plant": {
        "acceleration_mps2": 1.25,
        "braking_mps2": 2.25,
        "steering_rate_radps": 0.11,
        "steering_lag_s": 0.2,
        "speed_lag_s": 0.3,
        "delay_s": 0.1,
        "noise": {"position_m": 0.02, "yaw_rad": 0.01, "speed_mps": 0.05, "seed": 42},
    },
}


def nested(path: str, value: object) -> dict[str, Any]:
    """Return a block in which one value is said; `path` parts its keys by dots."""
    for key in reversed(path.split(".")):
        value = {key: value}
    assert isinstance(value, dict)
    return value


def test_a_vehicle_of_which_nothing_is_said_can_do_what_is_usual() -> None:
    assert VehicleBlock().to_limits() == VehicleLimits()


def test_limits_that_are_said_hold() -> None:
    assert VehicleBlock.model_validate(EVERYTHING).to_limits() == VehicleLimits(
        wheelbase_m=2.5,
        max_steering_angle_rad=0.5,
        max_speed_mps=6.5,
        braking_mps2=2.25,
        steering_rate_radps=0.11,
        steering_delay_s=0.2 + 0.1,
    )


def numbers(block: dict[str, Any], below: str = "") -> list[str]:
    """List the paths of all numbers of a block."""
    found = []
    for key, value in block.items():
        found += numbers(value, f"{below}{key}.") if isinstance(value, dict) else [below + key]
    return found


@pytest.mark.parametrize("path", numbers(EVERYTHING))
def test_a_whole_number_is_as_good_as_another_in_python_and_in_json(path: str) -> None:
    whole = nested(path, 1)

    assert VehicleBlock.model_validate(whole) == VehicleBlock.model_validate_json(json.dumps(whole))


@pytest.mark.parametrize("path", numbers(EVERYTHING))
@pytest.mark.parametrize("wrong", [True, "1", [1.0], float("nan"), float("inf"), 10**400])
def test_what_is_no_number_is_refused_where_it_stands(path: str, wrong: object) -> None:
    with pytest.raises(ValidationError) as caught:
        VehicleBlock.model_validate(nested(path, wrong))

    (fault,) = caught.value.errors()
    assert ".".join(map(str, fault["loc"])) == path


@pytest.mark.parametrize(
    ("path", "wrong", "right"),
    [
        ("wheelbase_m", 0.09, 0.1),
        ("wheelbase_m", 20.1, 20.0),
        ("max_steering_angle_rad", 0.0, 0.01),
        ("max_steering_angle_rad", 1.51, 1.5),
        ("max_speed_mps", 0.0, 0.1),
        ("max_speed_mps", 101.0, 100.0),
        ("pose.x_m", 1.1e7, 1e7),
        ("pose.y_m", -1.1e7, -1e7),
        ("plant.acceleration_mps2", 0.0, 0.01),
        ("plant.braking_mps2", -1.0, 0.01),
        ("plant.steering_rate_radps", 0.0, 0.01),
        ("plant.steering_lag_s", -0.1, 0.0),
        ("plant.speed_lag_s", 61.0, 60.0),
        ("plant.delay_s", -0.1, 0.0),
        ("plant.noise.position_m", -0.1, 0.0),
        ("plant.noise.yaw_rad", 101.0, 100.0),
        ("plant.noise.speed_mps", -0.1, 0.0),
        ("plant.noise.seed", -1, 0),
        ("plant.noise.seed", 1.0, 1),
        ("plant.noise.seed", 2**63, 2**63 - 1),
    ],
)
def test_a_number_out_of_range_is_refused_and_its_bound_is_taken(
    path: str, wrong: float, right: float
) -> None:
    with pytest.raises(ValidationError, match=path.rpartition(".")[2]):
        VehicleBlock.model_validate(nested(path, wrong))

    VehicleBlock.model_validate(nested(path, right))


@pytest.mark.parametrize("path", ["wheel_base_m", "pose.z_m", "plant.lag_s", "plant.noise.gps_m"])
def test_a_key_that_means_nothing_is_refused(path: str) -> None:
    with pytest.raises(ValidationError, match="Extra inputs are not permitted"):
        VehicleBlock.model_validate(nested(path, 1.0))


@pytest.mark.parametrize("path", ["pose", "plant", "plant.noise"])
def test_a_value_where_a_block_should_be_is_refused(path: str) -> None:
    with pytest.raises(ValidationError, match="valid dictionary or instance"):
        VehicleBlock.model_validate(nested(path, 1.0))
