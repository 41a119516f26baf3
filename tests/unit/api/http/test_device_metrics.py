"""The metrics of devices, as Prometheus is told."""

from tests.support.http_robot import HttpRobot, http_robot
from tests.support.robot_with_devices import (
    BASE_COMPUTER,
    device_robot,
    heard,
    status,
)


async def samples(robot: HttpRobot) -> list[str]:
    lines = (await robot.http.get("/metrics")).text.splitlines()
    return [line.removeprefix("pilothouse_") for line in lines if line.startswith(PREFIX)]


PREFIX = "pilothouse_device_"


async def test_each_connection_has_its_figures() -> None:
    async with device_robot() as (robot, link):
        robot.supervisor.submit(status(BASE_COMPUTER))
        link.connections[BASE_COMPUTER] = heard(robot.clock.now())
        await robot.pass_time(0.25)

        assert await samples(robot) == [
            'device_connected{device="base"} 1.0',
            'device_connected{device="arm"} 0.0',
            'device_round_trip_seconds{device="base"} 0.1',
            'device_lost_ratio{device="base"} 0.02',
            'device_heard_age_seconds{device="base"} 0.25',
            'device_messages_dropped_total{device="base"} 3.0',
            'device_messages_dropped_total{device="arm"} 0.0',
        ]


async def test_a_robot_of_one_computer_has_none() -> None:
    async with http_robot() as robot:
        assert await samples(robot) == []
