"""`/examples/tracks`: something to drive before one has a track of one's own."""

from tests.support.http_robot import HttpRobot


async def test_the_tracks_that_come_along_are_listed(robot: HttpRobot) -> None:
    items = (await robot.get("/examples/tracks"))["items"]

    assert [item["name"] for item in items] == ["loop"]


async def test_a_track_can_be_driven_as_it_comes(robot: HttpRobot) -> None:
    track = await robot.http.get("/examples/tracks/loop")
    assert track.headers["content-type"].startswith("text/csv")
    answer = await robot.http.post(
        "/tasks", content=track.text, headers={"Content-Type": "text/csv"}
    )

    assert answer.status_code == 201
    assert 700 < answer.json()["length_m"] < 900


async def test_names_are_no_paths(robot: HttpRobot) -> None:
    for name in ("actuation.yaml", "..%2Factuation", "other"):
        assert (await robot.http.get(f"/examples/tracks/{name}")).status_code == 404


async def test_a_real_vehicle_is_offered_none(robot: HttpRobot) -> None:
    robot.supervisor.simulated = ("signals",)

    assert (await robot.get("/examples/tracks"))["items"] == []
    assert (await robot.http.get("/examples/tracks/loop")).status_code == 404
