"""`/vehicle` as an operator sees it."""

import pytest

from domain.simulation.vehicle_settings import Plant, VehicleSettings
from tests.support.http_robot import HttpRobot, http_robot

LINE = "".join(f"{x},0,0\n" for x in range(11))
LONG = "0,0,0\n500,0,0\n"


async def test_a_parked_vehicle_is_told_nothing_and_steers_to_nothing(robot: HttpRobot) -> None:
    assert await robot.get("/vehicle") == {
        "pose": {"x_m": 0.0, "y_m": 0.0, "yaw_rad": 0.0},
        "speed_mps": 0.0,
        "steering_angle_rad": 0.0,
        "command": {"speed_mps": 0.0, "steering_angle_rad": 0.0},
        "lookahead": None,
        "at": "2026-01-01T00:00:00.000Z",
        "still_moving": None,
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


async def test_a_stop_that_does_not_stop_is_told_on_every_way_out() -> None:
    soft = VehicleSettings(plant=Plant(braking_mps2=0.05))
    async with http_robot(vehicle=soft) as robot:
        await robot.http.post("/tasks", content=LONG, headers={"Content-Type": "text/csv"})
        await robot.pass_time(5)
        await robot.http.put("/emergency_stop", json={"engaged": True, "reason": "a child"})
        await robot.pass_time(34)

        state, vehicle = await robot.get("/system_state"), await robot.get("/vehicle")
        assert [each["code"] for each in state["reasons"]] == ["STILL_MOVING", "ESTOP"]
        assert (state["errors"], state["error_code"]) == (["ESTOP"], 2)
        assert vehicle["still_moving"] == state["reasons"][0]
        assert vehicle["still_moving"]["value"] == pytest.approx(2.6, abs=0.1)
        assert vehicle["still_moving"]["since_at"] == "2026-01-01T00:00:05.000Z"
        assert vehicle["speed_mps"] == pytest.approx(1.1, abs=0.05)
        assert (await robot.get("/emergency_stop"))["standstill_at"] is None
        (told,) = (await robot.get("/events?kind=vehicle.still_moving"))["items"]
        assert told["notable"]
        assert told["words"] == vehicle["still_moving"]["message"]
