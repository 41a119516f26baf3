import pytest

from tests.support.stored_robot import boot_of
from tests.support.viewer import Viewer


async def test_speed_pause_and_time_are_asked_for(viewer: Viewer) -> None:
    boot = boot_of(1)
    answer = await viewer.put(paused=True, speed=0.5)
    assert answer.json()["paused"] is True

    answer = await viewer.put(at="2026-01-01T00:00:02Z")

    assert answer.json() == {
        "robot": "robot",
        "from_at": boot.wall_at.isoformat(timespec="milliseconds").replace("+00:00", "Z"),
        "to_at": answer.json()["to_at"],
        "at": "2026-01-01T00:00:02.000Z",
        "speed": 0.5,
        "paused": True,
        "fault": None,
    }
    assert (await viewer.http.get("/replay")).json() == answer.json()
    assert "gate" in {hold["owner"] for hold in (await viewer.http.get("/holds")).json()["items"]}


@pytest.mark.parametrize(
    "wish", [{"speed": 0.01}, {"speed": 1000}, {"speed": "fast"}, {"at": "noon"}, {"paus": True}]
)
async def test_what_the_player_cannot_do_is_rejected(
    viewer: Viewer, wish: dict[str, object]
) -> None:
    assert (await viewer.put(**wish)).status_code == 422


async def test_a_page_of_another_site_cannot_touch_the_player(viewer: Viewer) -> None:
    answer = await viewer.http.put(
        "/replay", json={"paused": True}, headers={"Origin": "http://elsewhere.example"}
    )

    assert answer.status_code == 403
    assert not viewer.player.is_paused
