"""`/vehicle` as an operator sees it."""

import pytest

from tests.support.http_robot import HttpRobot

LINE = "".join(f"{x},0,0\n" for x in range(11))


async def test_a_parked_vehicle_is_told_nothing_and_steers_to_nothing(robot: HttpRobot) -> None:
    assert await robot.get("/vehicle") == {
        "pose": {"x_m": 0.0, "y_m": 0.0, "yaw_rad": 0.0},
        "speed_mps": 0.0,
        "steering_angle_rad": 0.0,
        "command": {"speed_mps": 0.0, "steering_angle_rad": 0.0},
        "lookahead": None,
        "at": "2026-01-01T00:00:00.000Z",
        "limits": {"wheelbase_m": 1.75, "max_steering_angle_rad": 0.61, "max_speed_mps": 11.2},
    }


async def test_a_driven_vehicle_shows_where_it_is_and_what_it_steers_to(robot: HttpRobot) -> None:
    await robot.http.post("/tasks", content=LINE, headers={"Content-Type": "text/csv"})
    await robot.pass_time(2)
    shown = await robot.get("/vehicle")

    assert shown["pose"]["x_m"] == pytest.approx(2.0, abs=0.2)
    assert shown["speed_mps"] == pytest.approx(2.0, abs=0.1)
    assert shown["command"]["speed_mps"] == pytest.approx(2.0, abs=0.1)
    assert shown["lookahead"]["x_m"] > shown["pose"]["x_m"]
    assert shown["at"] == "2026-01-01T00:00:02.000Z"
