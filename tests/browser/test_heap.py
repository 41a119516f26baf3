"""A page that is kept open: what it keeps in memory stays as it is."""

import os

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from tests.browser.station import CHROMIUM, Service
from tests.support.page_bench.opened import OpenedPage, opened

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(
        os.environ.get("PILOTHOUSE_SOAK") != "1", reason="takes a quarter of an hour: make soak"
    ),
    pytest.mark.skipif(not CHROMIUM.exists(), reason=f"there is no {CHROMIUM}"),
]

WARM_UP_MINUTES = 5
"""The engine compiles what it runs often, 0.8 MB of code meanwhile, and the timeline fills."""
MINUTES = 10
MOST_GROWTH = 0.1


def test_the_heap_of_a_page_stays_as_it_is_while_the_robot_drives(service: Service) -> None:
    with opened(service.url) as page:
        page.drawn_s()
        for _ in range(WARM_UP_MINUTES):
            work(page, service, 60)
        before = page.heap_mb()
        for _ in range(MINUTES):
            work(page, service, 60)
        after = page.heap_mb()

    print(f"heap: {before:.2f} MB, {MINUTES} min later {after:.2f} MB")
    assert after < before * (1 + MOST_GROWTH)


def work(page: OpenedPage, service: Service, seconds: int) -> None:
    """Let the robot begin a task, fall into an error and come out of it, in that time."""
    pose = service.pose()
    ahead = [{**pose, "x_m": pose["x_m"] + 2.0 * n, "yaw_rad": 0.0} for n in range(60)]
    service.request("POST", "/tasks", {"waypoints": ahead, "speed_mps": 2.8})
    page.page.wait_for_timeout(500 * seconds)
    service.request("PATCH", "/mock/battery_level", {"value": 0.1, "publishing": True})
    page.page.wait_for_timeout(500 * seconds - 10_000)
    service.request("PATCH", "/mock/battery_level", {"value": 0.9, "publishing": True})
    page.page.wait_for_timeout(10_000)
