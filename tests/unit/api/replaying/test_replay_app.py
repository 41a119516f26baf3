"""The interface of a recorded robot: everything can be read, and nothing changes."""

from tests.support.recorded_robot import RecordedRobot
from tests.support.viewer import Viewer
from tests.support.websocket import WebSocketClient


async def test_it_can_be_read_like_a_robot(viewer: Viewer, robot: RecordedRobot) -> None:
    await viewer.clock.advance(1)

    for path in ("/system_state", "/tasks", "/vehicle", "/holds", "/signals", "/events", "/docs"):
        assert (await viewer.http.get(path)).status_code == 200, path
    events = (await viewer.http.get("/events")).json()["items"]
    assert events[-1]["id"] == robot.events[-1].id
    task = (await viewer.http.get("/tasks")).json()["items"][-1]["id"]
    assert (await viewer.http.get(f"/tasks/{task}/waypoints")).status_code == 200


async def test_the_stream_says_that_it_is_a_recording_and_goes_on_20_times_a_second(
    viewer: Viewer,
) -> None:
    async with WebSocketClient(viewer.app, "/ws") as client:
        hello = await client.frame("hello")
        first = await client.frame("state")
        await viewer.clock.advance(0.05)
        following = await client.frame("state")

        assert hello["replay"]["robot"] == "robot"
        assert hello["replay"]["speed"] == 10
        assert following["seq"] > first["seq"]
        client.send({"type": "reading", "signal": "estop", "value": True})
        assert (await client.frame("problem"))["code"] == "RECORDING"
