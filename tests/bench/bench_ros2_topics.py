"""What it costs to watch a ROS topic of large messages, and how exact its statistics are.

For `make bench-ros2`; needs ROS 2.
"""

import asyncio
import time
from importlib import import_module
from importlib.util import find_spec

import pytest

from domain.inputs import Readings
from service.clock import MonotonicClock
from service.files.robot_file import robot_settings_of
from service.ros.backend.topic_statistics import TopicStatistics
from tests.ros2.support.camera_process import camera
from tests.ros2.support.isolation import isolate
from tests.support.bench import report
from tests.support.models import actuation_model

pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(find_spec("rclpy") is None, reason="needs ROS 2: make bench-ros2"),
]

RATE_HZ = 30.0
SIZES = {"1 kB": 1_000, "1 MB": 1_000_000}
SETTLE_S = 6.0
MEASURED_S = 20.0
WATCHED = {"topic": "/image", "type": "sensor_msgs/msg/Image"}
STATISTICS = {
    "image_rate": {**WATCHED, "statistic": "rate"},
    "image_gap": {**WATCHED, "statistic": "gap"},
    "image_age": {**WATCHED, "statistic": "age"},
}


async def watch(*, watched: bool) -> dict[str, float]:
    """Return the share of a core that this process took, and the last statistics."""
    statistics = STATISTICS if watched else {}
    sent = {"signals": {name: {} for name in statistics}, "ros2": {"statistics": statistics}}
    link = import_module("service.ros.graph.link").RosLink()
    topics = TopicStatistics(robot_settings_of(sent, actuation_model()), link, MonotonicClock())
    values: dict[str, float] = {}

    def take(readings: Readings) -> None:
        values.update((item.signal, float(item.value)) for item in readings.items)

    topics.start()
    running = asyncio.create_task(topics.run(take))
    await asyncio.sleep(SETTLE_S)
    began, spent = time.perf_counter(), time.process_time()
    await asyncio.sleep(MEASURED_S)
    share = (time.process_time() - spent) / (time.perf_counter() - began)
    running.cancel()
    await link.close()
    return {"core_percent": round(100 * share, 2), **{k: round(v, 4) for k, v in values.items()}}


def test_watching_a_topic_of_large_messages() -> None:
    isolate()
    rows: dict[str, dict[str, float]] = {}
    for label, size in SIZES.items():
        with camera(RATE_HZ, size):
            rows[f"{label}, not watched"] = asyncio.run(watch(watched=False))
            rows[f"{label}, watched"] = asyncio.run(watch(watched=True))
    report(
        "ros2_topics",
        "Statistics of a ROS topic",
        f"A camera in another process publishes images at {RATE_HZ:g} Hz; rate, gap and age of its "
        f"topic are signals. CPU of the watching process over {MEASURED_S:g} s, and the same"
        " process without the subscription.",
        rows,
        asked="rate within 2 %; 1 MB messages at 3 % of a core or less",
        command="make bench-ros2",
    )
